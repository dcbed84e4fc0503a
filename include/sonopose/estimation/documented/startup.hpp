#pragma once
/// \file
/// Start-up: measures the gyroscope offset and the direction of gravity while the body is still.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::StartupSettings;

struct StartupState {
  TimeNs began_ns = 0;         ///< time of the first IMU sample; 0 before it
  TimeNs window_began_ns = 0;  ///< time of the first sample of the current window
  int window_samples = 0;
  Vector3d gyro_mean = Vector3d::Zero();
  Vector3d gyro_squares = Vector3d::Zero();  ///< Welford's sum of squared deviations
  Vector3d accel_mean = Vector3d::Zero();
  Vector3d accel_squares = Vector3d::Zero();
  bool window_has_fix = false;
  Vector3d window_fix_world_m = Vector3d::Zero();  ///< first fix of the window
  Vector3d window_moved_m = Vector3d::Zero();  ///< largest distance of a later fix from the first, per axis
  bool waiting = true;                         ///< true while the start waits for stillness
  bool calibrated = false;                     ///< true once the offset was measured
  TimeNs ended_ns = 0;                         ///< end of the rest that calibrated
  Vector3d gyro_offset_body_radps = Vector3d::Zero();

  bool operator==(const StartupState&) const = default;
};

namespace startup {

/// Effect of one sample.
enum class Progress {
  none,
  calibrated,  ///< the offset is now known, and gravity is `accel_mean`
  gave_up      ///< the time is over; the offset stays zero until the body comes to rest
};

/// Starts a new window at `time_ns`.
void begin_window(StartupState& state, TimeNs time_ns);

/// Adds one IMU sample to the window. Without a rest at the start, the first later rest calibrates. Fixes
/// scattered by no more than their noise show no motion.
Progress update(const StartupSettings& settings, StartupState& state, const ImuSample& imu,
                const Vector3d& fix_noise_world_m = Vector3d::Zero());

/// Adds an admitted fix. Fixes that are far apart show motion.
void update(StartupState& state, const UltrasonicFix& fix);

}  // namespace startup
}  // namespace sonopose::estimation::documented
