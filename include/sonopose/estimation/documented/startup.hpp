#pragma once
/// \file
/// Start-up: the gyroscope's offset and the direction of gravity, taken while the body is still.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::StartupSettings;

struct StartupState {
  TimeNs began_ns = 0;         ///< first IMU sample; 0 before it
  TimeNs window_began_ns = 0;  ///< first sample of the window that is being watched
  int window_samples = 0;
  Vector3d gyro_mean = Vector3d::Zero();
  Vector3d gyro_squares = Vector3d::Zero();  ///< Welford's sum of squared deviations
  Vector3d accel_mean = Vector3d::Zero();
  Vector3d accel_squares = Vector3d::Zero();
  bool window_has_fix = false;
  Vector3d window_fix_world_m = Vector3d::Zero();  ///< the window's first fix
  bool window_moved = false;                       ///< a later one lay too far from it
  bool waiting = true;                             ///< the start still waits for stillness
  bool calibrated = false;                         ///< the offset has been taken
  TimeNs ended_ns = 0;                             ///< end of the rest that calibrated
  Vector3d gyro_offset_body_radps = Vector3d::Zero();

  bool operator==(const StartupState&) const = default;
};

namespace startup {

/// What one sample has brought about.
enum class Progress {
  none,
  calibrated,  ///< just now: the offset is known, gravity is `accel_mean`
  gave_up      ///< just now: not still within the time; the offset stays zero until the body comes to rest
};

/// Begins to watch anew at this time: the samples before it are too far from those after it.
void begin_window(StartupState& state, TimeNs time_ns);

/// Watches one IMU sample. Without a rest at the start it goes on watching, so that the first rest
/// calibrates.
Progress watch(const StartupSettings& settings, StartupState& state, const ImuSample& imu);

/// Takes note of an admitted fix.
void watch(const StartupSettings& settings, StartupState& state, const UltrasonicFix& fix);

}  // namespace startup
}  // namespace sonopose::estimation::documented
