#include <sonopose/estimation/kalman/rest.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman::rest {
namespace {

// No multiple of a usual sample interval: a microsecond in a stamp must not decide which sample ends a
// window.
constexpr double window_s = 0.4975;
constexpr int least_samples = 8;
constexpr double still_accel_std_mps2 = 0.06;
constexpr double still_gyro_std_radps = 0.006;
constexpr double rate_above_bias_radps = 0.015;

void accumulate(Vector3d& mean, Vector3d& squares, const Vector3d& value, int samples) {
  const Vector3d before = value - mean;
  mean += before / samples;
  squares += before.cwiseProduct(value - mean);
}

void begin_window(RestState& state, TimeNs time_ns) {
  state.window_began_ns = time_ns;
  state.samples = 0;
  state.gyro_mean.setZero();
  state.gyro_squares.setZero();
  state.accel_mean.setZero();
  state.accel_squares.setZero();
}

void forget_fixes(RestState& state) {
  state.fixes = 0;
  state.time_mean_s = 0;
  state.time_squares_s2 = 0;
  state.position_mean_m.setZero();
  state.products_m_s.setZero();
}

}  // namespace

bool update(RestState& state, TimeNs time_ns, const Vector3d& rate_body_radps,
            const Vector3d& force_body_mps2, const Vector3d& gyro_bias_body_radps, double bias_std_radps) {
  if (state.window_began_ns == 0) begin_window(state, time_ns);
  ++state.samples;
  accumulate(state.gyro_mean, state.gyro_squares, rate_body_radps, state.samples);
  accumulate(state.accel_mean, state.accel_squares, force_body_mps2, state.samples);
  if (state.samples < least_samples || seconds_between(state.window_began_ns, time_ns) < window_s) {
    return false;
  }
  const auto std_of = [&](const Vector3d& squares) { return std::sqrt(squares.maxCoeff() / state.samples); };
  const double off_bias_radps = (state.gyro_mean - gyro_bias_body_radps).norm();
  const bool still = std_of(state.accel_squares) < still_accel_std_mps2 &&
                     std_of(state.gyro_squares) < still_gyro_std_radps &&
                     off_bias_radps < rate_above_bias_radps + 3.0 * bias_std_radps;
  if (still) {
    if (state.still_windows == 0) {
      state.still_since_ns = state.window_began_ns;
      forget_fixes(state);
    }
    ++state.still_windows;
    state.still_gyro_mean = state.gyro_mean;
    state.still_accel_mean = state.accel_mean;
  } else {
    state.still_windows = 0;
  }
  begin_window(state, time_ns);
  return still;
}

void add_fix(RestState& state, TimeNs time_ns, const Vector3d& position_world_m) {
  if (state.still_windows == 0) return;
  ++state.fixes;
  const double time_s = seconds_between(state.still_since_ns, time_ns);
  const double before_s = time_s - state.time_mean_s;
  state.time_mean_s += before_s / state.fixes;
  state.time_squares_s2 += before_s * (time_s - state.time_mean_s);
  const Vector3d offset_m = position_world_m - state.position_mean_m;
  state.position_mean_m += offset_m / state.fixes;
  state.products_m_s += before_s * (position_world_m - state.position_mean_m);
}

void restart(RestState& state) {
  state = RestState{};
}

bool fixes_stand_still(const RestState& state, double fix_std_m) {
  constexpr int enough = 4;
  constexpr double drift_mps = 0.004;
  constexpr double sigmas = 2.8;
  if (state.fixes < enough || !(state.time_squares_s2 > 0.0)) return false;
  const double slope_mps = (state.products_m_s / state.time_squares_s2).norm();
  return slope_mps < drift_mps + sigmas * fix_std_m / std::sqrt(state.time_squares_s2);
}

}  // namespace sonopose::estimation::kalman::rest
