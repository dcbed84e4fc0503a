#pragma once
/// \file
/// Keeps what the estimators learn of the sensors in a file, for the next start.

#include "config/learned_file.hpp"
#include "fusion/beacon_estimators.hpp"
#include "threads/guarded.hpp"

#include <filesystem>
#include <future>
#include <optional>
#include <string>

namespace sonopose::fusion {

/// Reads the file and returns what it still says of each beacon at this time of the host's clock. A file that
/// cannot be used is a warning: a start needs none.
KnownOfBeacons read_known(const std::filesystem::path& file, TimeNs host_now_ns);

/// Saves the estimates once a minute and at the end, on a thread of its own: a slow disk delays no pose.
/// Beacons that have not been heard keep what they have in the file.
class LearnedSensorsFile {
public:
  explicit LearnedSensorsFile(const std::filesystem::path& file);
  LearnedSensorsFile(const LearnedSensorsFile&) = delete;
  LearnedSensorsFile& operator=(const LearnedSensorsFile&) = delete;
  /// Waits for the file.
  ~LearnedSensorsFile() = default;

  /// Saves if a minute has passed since the last time.
  void update(threads::Guarded<BeaconEstimators>& estimators, SteadyTime now);
  /// Saves, and waits until the file is written.
  void finish(threads::Guarded<BeaconEstimators>& estimators);

private:
  void save(threads::Guarded<BeaconEstimators>& estimators);
  void report_error();

  std::filesystem::path file_;
  SteadyTime due_;
  std::future<std::string> writing_;  ///< gives an error; empty if the file was written
  std::string reported_;              ///< error of the last time
};

}  // namespace sonopose::fusion
