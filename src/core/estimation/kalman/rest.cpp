#include <sonopose/estimation/kalman/rest.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {

void Trend::add(TimeNs time_ns, const Vector3d& value) {
  constexpr double memory_s = 5.0;
  const double step_s = samples == 0 ? 0.0 : seconds_between(latest_ns, time_ns);
  const double forgetting_factor = std::exp(-std::max(0.0, step_s) / memory_s);
  latest_ns = time_ns;
  time_mean_s -= step_s;
  weight = forgetting_factor * weight + 1.0;
  time_squares_s2 *= forgetting_factor;
  products *= forgetting_factor;
  const double before_s = -time_mean_s;
  time_mean_s += before_s / weight;
  time_squares_s2 += before_s * -time_mean_s;
  mean += (value - mean) / weight;
  products += before_s * (value - mean);
  samples = std::min(samples + 1, 1000);
}

namespace rest {
namespace {

// Not a multiple of a usual sample interval: a microsecond in a stamp must not decide which sample ends a
// window.
constexpr double window_s = 0.4975;
constexpr int min_samples = 8;
constexpr double still_accel_std_mps2 = 0.06;
constexpr double still_gyro_std_radps = 0.006;
constexpr double rate_above_bias_radps = 0.015;

void accumulate(Vector3d& mean, Vector3d& squares, const Vector3d& value, double share) {
  const Vector3d before = value - mean;
  mean += share * before;
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

/// True if no axis has a significant slope.
bool is_steady(const Trend& trend, double slowest, const Vector3d& std) {
  constexpr double sigmas = 2.4;  // exceeded by 5 % of the trends of three axes without a slope
  if (!(trend.time_squares_s2 > 0.0)) return false;
  const Eigen::Array3d slopes = (trend.products / trend.time_squares_s2).array().abs();
  return (slopes < slowest + sigmas * std.array() / std::sqrt(trend.time_squares_s2)).all();
}

}  // namespace

bool add_sample(RestState& state, TimeNs time_ns, const Vector3d& rate_body_radps,
                const Vector3d& force_body_mps2) {
  if (state.window_began_ns == 0) begin_window(state, time_ns);
  ++state.samples;
  const double share = 1.0 / state.samples;
  accumulate(state.gyro_mean, state.gyro_squares, rate_body_radps, share);
  accumulate(state.accel_mean, state.accel_squares, force_body_mps2, share);
  return state.samples >= min_samples && seconds_between(state.window_began_ns, time_ns) >= window_s;
}

bool end_window(RestState& state, TimeNs time_ns, const Vector3d& gyro_bias_body_radps,
                double bias_std_radps) {
  const auto std_of = [&](const Vector3d& squares) { return std::sqrt(squares.maxCoeff() / state.samples); };
  const double off_bias_radps = (state.gyro_mean - gyro_bias_body_radps).norm();
  const bool still = std_of(state.accel_squares) < still_accel_std_mps2 &&
                     std_of(state.gyro_squares) < still_gyro_std_radps &&
                     off_bias_radps < rate_above_bias_radps + 3.0 * bias_std_radps;
  if (still) {
    if (state.still_windows == 0) {
      state.still_since_ns = state.window_began_ns;
      state.fixes = state.headings = Trend{};
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
  if (state.still_windows > 0) state.fixes.add(time_ns, position_world_m);
}

void add_heading(RestState& state, TimeNs time_ns, double heading_rad) {
  if (state.still_windows == 0) return;
  if (state.headings.samples == 0) state.first_heading_rad = heading_rad;
  state.headings.add(time_ns, {geometry::wrap_angle(heading_rad - state.first_heading_rad), 0.0, 0.0});
}

void restart(RestState& state) {
  state = RestState{};
}

bool fixes_stand_still(const RestState& state, const Vector3d& fix_std_m, int min_fixes) {
  constexpr double drift_mps = 0.004;
  return state.still_windows >= 1 && state.fixes.samples >= min_fixes &&
         is_steady(state.fixes, drift_mps, fix_std_m);
}

// A standing body may sway slowly by a bounded angle: the longer it stands, the less its mean rate differs
// from the bias. The variances add up to that of the mean over the whole rest.
double still_rate_variance(const RestState& state, TimeNs now_ns) {
  constexpr double max_turn_rad = 0.006;
  constexpr double min_std_radps = 3e-4;
  const double still_s = seconds_between(state.still_since_ns, now_ns);
  const double information_s2 = window_s * (2.0 * still_s - window_s);
  return std::max(min_std_radps * min_std_radps, max_turn_rad * max_turn_rad / information_s2);
}

double still_velocity_variance(const RestState& state, TimeNs now_ns) {
  constexpr double max_shift_m = 0.03;
  constexpr double min_std_mps = 0.01;
  const double std_mps = std::max(min_std_mps, max_shift_m / seconds_between(state.still_since_ns, now_ns));
  return std_mps * std_mps;
}

bool headings_turn(const RestState& state, double heading_std_rad) {
  constexpr int min_headings = 4;
  constexpr double drift_radps = 0.005;
  return state.headings.samples >= min_headings &&
         !is_steady(state.headings, drift_radps, {heading_std_rad, 0.0, 0.0});
}

}  // namespace rest
}  // namespace sonopose::estimation::kalman
