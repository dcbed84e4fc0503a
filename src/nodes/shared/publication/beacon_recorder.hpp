#pragma once
/// \file
/// Records the published samples of a bridge, in one sensor-log folder per beacon.

#include "recording/log_writer.hpp"
#include "recording/part_folder.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <map>

namespace sonopose::publication {

/// Records each beacon to `folder.part/beacon_<address>`. At the end `folder` contains these logs, or is
/// itself the log of the only beacon.
class BeaconRecorder {
public:
  /// `settings`: settings of the source. Throws files::IoError if `folder` is not empty, or `folder.part`
  /// exists.
  explicit BeaconRecorder(const std::filesystem::path& folder, recording::LogSettings settings = {});

  BeaconRecorder(const BeaconRecorder&) = delete;
  BeaconRecorder& operator=(const BeaconRecorder&) = delete;
  /// Removes the folder of a recording without a beacon.
  ~BeaconRecorder();

  void write(const Event& event) { log_of(address_of(event)).write(event); }
  void write(const TruthSample& truth) { log_of(truth.address).write(truth); }

  /// Passes all lines to the operating system. Throws files::IoError, like `write`.
  void flush();

  /// Ends the recording and gives it its name, unless it is empty. Throws files::IoError.
  void finish();

  /// True if no beacon was heard.
  [[nodiscard]] bool is_empty() const { return logs_.empty(); }

  /// Temporary name of the folder.
  [[nodiscard]] const std::filesystem::path& part() const { return folder_.part(); }

private:
  [[nodiscard]] std::filesystem::path part_of(BeaconAddress address) const;
  recording::SensorLogWriter& log_of(BeaconAddress address);

  recording::PartFolder folder_;
  recording::LogSettings settings_;
  std::map<BeaconAddress, recording::SensorLogWriter> logs_;
  bool finished_ = false;
};

}  // namespace sonopose::publication
