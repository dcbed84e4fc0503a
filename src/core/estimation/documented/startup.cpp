#include <sonopose/estimation/documented/startup.hpp>

namespace sonopose::estimation::documented::startup {

void begin_window(StartupState& state, TimeNs time_ns) {
  state.window_began_ns = time_ns;
  state.window_samples = 0;
  state.gyro_mean.setZero();
  state.gyro_squares.setZero();
  state.accel_mean.setZero();
  state.accel_squares.setZero();
  state.window_has_fix = false;
  state.window_moved_m.setZero();
}

namespace {

/// Welford's running mean and sum of squares.
void accumulate(Vector3d& mean, Vector3d& squares, const Vector3d& value, int samples) {
  const Vector3d before = value - mean;
  mean += before / samples;
  squares += before.cwiseProduct(value - mean);
}

bool is_still(const StartupSettings& settings, const StartupState& state, const Vector3d& fix_noise_world_m) {
  const auto spread_below = [&state](const Vector3d& squares, double std) {
    return squares.maxCoeff() <= std * std * state.window_samples;
  };
  constexpr double max_sigmas = 5.0;
  const Vector3d allowed_m = (max_sigmas * fix_noise_world_m).cwiseMax(settings.still_moved_m);
  return state.window_moved_m.cwiseQuotient(allowed_m).norm() <= 1.0 &&
         state.gyro_mean.cwiseAbs().maxCoeff() <= settings.max_gyro_offset_radps &&
         spread_below(state.gyro_squares, settings.still_gyro_std_radps) &&
         spread_below(state.accel_squares, settings.still_accel_std_mps2);
}

}  // namespace

Progress update(const StartupSettings& settings, StartupState& state, const ImuSample& imu,
                const Vector3d& fix_noise_world_m) {
  if (state.calibrated) return Progress::none;
  if (state.began_ns == 0) {
    state.began_ns = imu.sensor_time_ns;
    begin_window(state, imu.sensor_time_ns);
  }
  ++state.window_samples;
  accumulate(state.gyro_mean, state.gyro_squares, imu.angular_velocity_body_radps, state.window_samples);
  accumulate(state.accel_mean, state.accel_squares, imu.specific_force_body_mps2, state.window_samples);

  // Fewer samples give no meaningful spread.
  constexpr int min_samples = 10;
  const double window_s = seconds_between(state.window_began_ns, imu.sensor_time_ns);
  if (window_s < settings.calibration_s || state.window_samples < min_samples) return Progress::none;

  if (is_still(settings, state, fix_noise_world_m)) {
    state.waiting = false;
    state.calibrated = true;
    state.ended_ns = imu.sensor_time_ns;
    state.gyro_offset_body_radps = state.gyro_mean;
    return Progress::calibrated;
  }
  begin_window(state, imu.sensor_time_ns);
  if (!state.waiting) return Progress::none;
  state.waiting = false;
  return Progress::gave_up;
}

void update(StartupState& state, const UltrasonicFix& fix) {
  if (state.calibrated) return;
  if (!state.window_has_fix) {
    state.window_has_fix = true;
    state.window_fix_world_m = fix.position_world_m;
    return;
  }
  const Vector3d moved_world_m = fix.position_world_m - state.window_fix_world_m;
  state.window_moved_m = state.window_moved_m.cwiseMax(moved_world_m.cwiseAbs());
}

}  // namespace sonopose::estimation::documented::startup
