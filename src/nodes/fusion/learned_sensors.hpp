#pragma once
/// \file
/// Keeps what the estimators learn of the sensors in a file, for the next start.

#include "config/learned_file.hpp"
#include "fusion/beacon_estimators.hpp"
#include "threads/guarded.hpp"

#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::fusion {

/// Saves the estimates once a minute and at the end, on a thread of its own: a slow disk delays no pose.
/// Beacons that have not been heard keep what they have in the file. The file has one writer. One that cannot
/// be read is a warning, since a start needs none, and is not replaced.
class LearnedSensorsFile {
public:
  /// Reads the file, and logs which beacons it knows, with these settings.
  LearnedSensorsFile(const std::filesystem::path& file, const config::FusionConfig& config);
  LearnedSensorsFile(const LearnedSensorsFile&) = delete;
  LearnedSensorsFile& operator=(const LearnedSensorsFile&) = delete;
  /// Waits for the file.
  ~LearnedSensorsFile() = default;

  /// Returns what is still known of a beacon that begins with these settings. Call it under the lock of the
  /// estimators.
  [[nodiscard]] std::optional<estimation::aiding::KnownSensors> known(BeaconAddress address,
                                                                      const settings::Settings& settings);

  /// Saves if a minute has passed since the last time.
  void update(threads::Guarded<BeaconEstimators>& estimators, SteadyTime now);
  /// Saves, and waits until the file is written.
  void finish(threads::Guarded<BeaconEstimators>& estimators);

private:
  /// The settings of calibration and mount that a beacon is learned with.
  struct Mounting {
    std::vector<std::string> settings;
    std::optional<SteadyTime> changed{};  ///< time at which a change was seen; empty: none since the start
  };

  void save(threads::Guarded<BeaconEstimators>& estimators);
  void report_last();
  void report(const std::string& error);

  std::filesystem::path file_;
  config::LearnedSensors learned_;  ///< changed and read under the lock of the estimators
  /// Mountings at the last time of saving, or at the start of a beacon. After a change a beacon is not saved
  /// until it has been learned again for some minutes.
  std::map<BeaconAddress, Mounting> mountings_;
  bool is_readable_ = true;
  SteadyTime due_;
  std::future<std::string> writing_;  ///< gives an error; empty if the file was written
  std::string reported_;              ///< error of the last time
};

}  // namespace sonopose::fusion
