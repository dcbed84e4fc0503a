#pragma once
/// \file
/// Runs the recorded car through the real programs.

#include "support/beacon_bytes.hpp"
#include "support/bus.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace sonopose::test {

inline const std::filesystem::path car_folder =
    std::filesystem::path(SONOPOSE_RECORDINGS) / "beacons" / "car";

/// Origin of the times in the car's log.
inline constexpr TimeNs car_epoch_ns = 1'700'000'000'000'000'000;
inline constexpr std::size_t car_imu_samples = 10'555;
inline constexpr std::size_t car_fixes = 1'182;

/// The data show an angle of 86° between the pair's axis and the car's.
inline const Arguments car_settings{"--set", "heading.mount_offset_deg=86"};

struct CarRun {
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
};

/// Plays the log folder (`source` "log") or the bytes ("stream") as fast as possible, with additional
/// settings.
CarRun play_car(const std::string& source, const std::string& engine, const Arguments& more = {});

/// A part of the recording: the log between two IMU samples, and the bytes with the same content plus some
/// more at the end.
struct CarPart {
  std::vector<Event> events;
  std::vector<TimedFrame> frames;
};
CarPart part_of_car(std::size_t first_imu_sample, std::size_t imu_samples);

/// Samples and poses received while a beacon sends the part over a serial line in real time.
struct LiveRun {
  std::vector<FusedPose> poses;
  std::vector<ImuSample> imu;
  std::vector<UltrasonicFix> fixes;
};
LiveRun play_over_serial_line(const CarPart& part, const std::string& engine);

/// Difference between the k-th poses of two runs.
struct Distance {
  double median = 0;
  double rms = 0;
  double max = 0;
};
struct RunDistance {
  Distance position_m;
  Distance velocity_mps;
  Distance yaw_rad;
};
RunDistance distance_between(const std::vector<FusedPose>& run, const std::vector<FusedPose>& other);

/// Returns true if the recording exists; otherwise prints that the test is skipped.
bool car_is_here();

}  // namespace sonopose::test
