#pragma once
/// \file
/// Start-up: measures the gyro offset and the direction of gravity while the body is still.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::StartupSettings;

struct StartupState {
  TimeNs began_ns = 0;         ///< first IMU sample; 0 before it
  TimeNs window_began_ns = 0;  ///< first sample of the present window
  int window_samples = 0;
  Vector3d gyro_mean = Vector3d::Zero();
  Vector3d gyro_squares = Vector3d::Zero();  ///< Welford's sum of squared deviations
  Vector3d accel_mean = Vector3d::Zero();
  Vector3d accel_squares = Vector3d::Zero();
  bool window_has_fix = false;
  Vector3d window_fix_world_m = Vector3d::Zero();  ///< the window's first fix
  Vector3d window_moved_m = Vector3d::Zero();      ///< largest distance of a later fix from it, per axis
  bool waiting = true;                             ///< the start waits for stillness
  bool calibrated = false;                         ///< the offset has been measured
  TimeNs ended_ns = 0;                             ///< end of the rest that calibrated
  Vector3d gyro_offset_body_radps = Vector3d::Zero();

  bool operator==(const StartupState&) const = default;
};

namespace startup {

/// The effect of one sample.
enum class Progress {
  none,
  calibrated,  ///< with this sample: the offset is known, gravity is `accel_mean`
  gave_up      ///< with this sample: the time is over; the offset stays zero until the body comes to rest
};

/// Starts a new window at this time.
void begin_window(StartupState& state, TimeNs time_ns);

/// Adds one IMU sample to the window. Without a rest at the start, the first later rest calibrates. Fixes
/// with this noise show no motion by it.
Progress update(const StartupSettings& settings, StartupState& state, const ImuSample& imu,
                const Vector3d& fix_noise_world_m = Vector3d::Zero());

/// Adds an admitted fix: fixes that are far apart show a motion.
void update(StartupState& state, const UltrasonicFix& fix);

}  // namespace startup
}  // namespace sonopose::estimation::documented
