#pragma once
/// \file
/// Records what a bridge publishes, in one sensor-log folder per beacon.

#include "recording/log_writer.hpp"
#include "recording/part_folder.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <map>

namespace sonopose::bridge {

/// While it records, each beacon's log is `folder.part/beacon_<address>`. At the end `folder` has these logs,
/// or is itself the log of the only beacon.
class BeaconRecorder {
public:
  /// `settings` are those of the source. Throws files::IoError if `folder` is not empty, or `folder.part`
  /// exists.
  explicit BeaconRecorder(const std::filesystem::path& folder, recording::LogSettings settings = {});

  BeaconRecorder(const BeaconRecorder&) = delete;
  BeaconRecorder& operator=(const BeaconRecorder&) = delete;
  /// A recording without a beacon leaves no folder.
  ~BeaconRecorder();

  void write(const Event& event) { log_of(address_of(event)).write(event); }
  void write(const TruthSample& truth) { log_of(truth.address).write(truth); }

  /// Passes all lines to the operating system. Throws files::IoError, as `write` does.
  void flush();

  /// Ends the recording and gives it its name, unless it is empty. Throws files::IoError.
  void finish();

  /// Whether no beacon was heard.
  [[nodiscard]] bool is_empty() const { return logs_.empty(); }

  /// What the folder is called until then.
  [[nodiscard]] const std::filesystem::path& part() const { return folder_.part(); }

private:
  [[nodiscard]] std::filesystem::path part_of(BeaconAddress address) const;
  recording::SensorLogWriter& log_of(BeaconAddress address);

  recording::PartFolder folder_;
  recording::LogSettings settings_;
  std::map<BeaconAddress, recording::SensorLogWriter> logs_;
  bool finished_ = false;
};

}  // namespace sonopose::bridge
