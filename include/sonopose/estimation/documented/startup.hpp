#pragma once
/// \file
/// Start-up: the gyroscope's offset and the direction of gravity, taken while the body is still.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>

namespace sonopose::estimation::documented {

struct StartupSettings {
  double calibration_s{};
  double still_gyro_std_radps{};
  double still_accel_std_mps2{};
  double max_gyro_offset_radps{};
  double still_moved_m{};

  static constexpr std::string_view group = "startup";
  static constexpr auto declarations() {
    using G = StartupSettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(own_setting, "calibration_s", &G::calibration_s, 1.0, {0.1, 30.0}, "s",
             "How long the body must be still for the gyro's offset to be taken, and how long the start "
             "waits."),
        real(own_setting, "still_gyro_std_radps", &G::still_gyro_std_radps, 0.03, {0.0, 1.0}, "rad/s",
             "Spread of each gyro axis below which the body counts as still."),
        real(own_setting, "still_accel_std_mps2", &G::still_accel_std_mps2, 0.3, {0.0, 10.0}, "m/s^2",
             "Spread of each accelerometer axis below which the body counts as still."),
        real(own_setting, "max_gyro_offset_radps", &G::max_gyro_offset_radps, 0.06, {0.0, 1.0}, "rad/s",
             "A mean rate beyond this is a turn and not an offset."),
        real(own_setting, "still_moved_m", &G::still_moved_m, 0.2, {0.01, 100.0}, "m",
             "Fixes that lie farther apart than this show a motion which an IMU at constant velocity cannot "
             "feel."));
  }
  constexpr StartupSettings() { settings::set_defaults(*this); }
};

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
