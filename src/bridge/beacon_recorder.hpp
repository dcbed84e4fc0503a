#pragma once
/// \file
/// Records what a bridge publishes, in one sensor-log folder per beacon.

#include "recording/log_writer.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <map>
#include <memory>

namespace sonopose::bridge {

/// The first beacon's log is `folder` itself; the others are in `folder/beacon_<address>`.
class BeaconRecorder {
public:
  /// Throws files::IoError if `folder` already contains a recording.
  explicit BeaconRecorder(std::filesystem::path folder);

  void write(const Event& event) { log_of(address_of(event)).write(event); }
  void write(const TruthSample& truth) { log_of(truth.address).write(truth); }

  /// Passes all lines to the operating system. Throws files::IoError, as `write` does.
  void flush();

private:
  recording::SensorLogWriter& log_of(BeaconAddress address);

  std::filesystem::path folder_;
  std::unique_ptr<recording::SensorLogWriter> first_;
  std::map<BeaconAddress, recording::SensorLogWriter*> by_address_;
  std::map<BeaconAddress, std::unique_ptr<recording::SensorLogWriter>> further_;
};

}  // namespace sonopose::bridge
