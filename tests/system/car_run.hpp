#pragma once
/// \file
/// The recorded car through the real programs, and what came out of them.

#include "support/bus.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace sonopose::test {

inline const std::filesystem::path car_folder =
    std::filesystem::path(SONOPOSE_RECORDINGS) / "beacons" / "car";

/// Its log's times count from here.
inline constexpr TimeNs car_epoch_ns = 1'700'000'000'000'000'000;
inline constexpr std::size_t car_imu_samples = 10'555;
inline constexpr std::size_t car_fixes = 1'182;

/// The pair's axis stands at 86° to the car's, as the data say.
inline const Arguments car_settings{"--set", "heading.mount_offset_deg=86"};

struct CarRun {
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
};

/// Plays the log folder (`source` "log") or the bytes ("stream") as fast as the programs take them.
CarRun play_car(const std::string& source);

/// The bytes as a beacon would send them now, paced by their contents, over a serial line.
CarRun play_car_over_serial_line();

/// How far two runs are apart, the k-th pose of one against the k-th of the other.
struct Distance {
  double rms = 0;
  double max = 0;
};
struct RunDistance {
  Distance position_m;
  Distance velocity_mps;
  Distance yaw_rad;
};
RunDistance distance_between(const std::vector<FusedPose>& run, const std::vector<FusedPose>& other);

/// Whether the recording is there; says that the test is skipped where it is not.
bool car_is_here();

}  // namespace sonopose::test
