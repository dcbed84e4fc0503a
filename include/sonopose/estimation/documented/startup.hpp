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
  int window_fixes = 0;
  double fix_time_mean_s = 0;  ///< since the window began
  double fix_time_squares_s2 = 0;
  Vector3d fix_mean_world_m = Vector3d::Zero();
  Vector3d fix_squares_m2 = Vector3d::Zero();
  Vector3d fix_products_ms = Vector3d::Zero();  ///< sum of the products of time and position, as deviations
  bool waiting = true;                          ///< true while the start waits for stillness
  bool calibrated = false;                      ///< true once the offset was measured
  TimeNs ended_ns = 0;                          ///< end of the rest that calibrated
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

/// Adds one IMU sample to the window. Without a rest at the start, the first later rest calibrates.
Progress update(const StartupSettings& settings, StartupState& state, const ImuSample& imu);

/// Adds an admitted fix. A trend of the fixes that exceeds their scatter shows motion.
void update(StartupState& state, const UltrasonicFix& fix);

}  // namespace startup
}  // namespace sonopose::estimation::documented
