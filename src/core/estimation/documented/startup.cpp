#include <sonopose/estimation/documented/startup.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::documented::startup {

void begin_window(StartupState& state, TimeNs time_ns) {
  state.window_began_ns = time_ns;
  state.window_samples = 0;
  state.gyro_mean.setZero();
  state.gyro_squares.setZero();
  state.accel_mean.setZero();
  state.accel_squares.setZero();
  state.window_fixes = 0;
  state.fix_time_mean_s = 0.0;
  state.fix_time_squares_s2 = 0.0;
  state.fix_mean_world_m.setZero();
  state.fix_squares_m2.setZero();
  state.fix_products_ms.setZero();
}

namespace {

/// Welford's running mean and sum of squares.
void accumulate(Vector3d& mean, Vector3d& squares, const Vector3d& value, int samples) {
  const Vector3d before = value - mean;
  mean += before / samples;
  squares += before.cwiseProduct(value - mean);
}

/// True if the fixes moved along a line by more than still_moved_m, and by more than their scatter explains.
bool have_fixes_moved(const StartupSettings& settings, const StartupState& state) {
  constexpr double max_sigmas = 5.0;
  constexpr double squared_span = 12.0;  // of evenly spaced times, in units of their variance
  const double squares_s2 = state.fix_time_squares_s2;
  if (squares_s2 <= 0.0) return false;
  const double span_s = std::sqrt(squared_span * squares_s2 / state.window_fixes);
  const Vector3d slope_mps = state.fix_products_ms / squares_s2;
  const Vector3d residual_m2 =
      (state.fix_squares_m2 - slope_mps.cwiseProduct(state.fix_products_ms)).cwiseMax(0.0);
  const Vector3d slope_std_mps =
      (residual_m2 / (std::max(1, state.window_fixes - 2) * squares_s2)).cwiseSqrt();
  const Vector3d allowed_m = (max_sigmas * span_s * slope_std_mps).cwiseMax(settings.still_moved_m);
  return (span_s * slope_mps).cwiseQuotient(allowed_m).norm() > 1.0;
}

bool is_still(const StartupSettings& settings, const StartupState& state) {
  const auto spread_below = [&state](const Vector3d& squares, double std) {
    return squares.maxCoeff() <= std * std * state.window_samples;
  };
  return !have_fixes_moved(settings, state) &&
         state.gyro_mean.cwiseAbs().maxCoeff() <= settings.max_gyro_offset_radps &&
         spread_below(state.gyro_squares, settings.still_gyro_std_radps) &&
         spread_below(state.accel_squares, settings.still_accel_std_mps2);
}

}  // namespace

Progress update(const StartupSettings& settings, StartupState& state, const ImuSample& imu) {
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

  if (is_still(settings, state)) {
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
  ++state.window_fixes;
  const double time_s = seconds_between(state.window_began_ns, fix.received_time_ns);
  const double before_s = time_s - state.fix_time_mean_s;
  const Vector3d before_m = fix.position_world_m - state.fix_mean_world_m;
  state.fix_time_mean_s += before_s / state.window_fixes;
  state.fix_mean_world_m += before_m / state.window_fixes;
  const Vector3d after_m = fix.position_world_m - state.fix_mean_world_m;
  state.fix_time_squares_s2 += before_s * (time_s - state.fix_time_mean_s);
  state.fix_squares_m2 += before_m.cwiseProduct(after_m);
  state.fix_products_ms += before_s * after_m;
}

}  // namespace sonopose::estimation::documented::startup
