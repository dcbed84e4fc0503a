#pragma once
/// \file
/// Records what a bridge publishes, a sensor-log folder for each beacon.

#include <sonopose/samples/samples.hpp>
#include "recording/log_writer.hpp"

#include <filesystem>
#include <map>
#include <memory>

namespace sonopose::bridge {

/// The first beacon's log is `folder` itself, further ones stand in `folder/beacon_<address>`.
class BeaconRecorder {
public:
  /// Throws io::LogError where `folder` holds a recording already.
  explicit BeaconRecorder(std::filesystem::path folder);

  void write(const Event& event) { log_of(address_of(event)).write(event); }
  void write(const TruthSample& truth) { log_of(truth.address).write(truth); }

private:
  recording::SensorLogWriter& log_of(BeaconAddress address);

  std::filesystem::path folder_;
  std::unique_ptr<recording::SensorLogWriter> first_;
  std::map<BeaconAddress, recording::SensorLogWriter*> by_address_;
  std::map<BeaconAddress, std::unique_ptr<recording::SensorLogWriter>> further_;
};

}  // namespace sonopose::bridge
