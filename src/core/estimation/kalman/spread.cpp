// Uncertainty that the best filter alone does not show.

#include "estimation/kalman/state_internal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sonopose::estimation::kalman {
namespace {

/// True for a track that the fixes left. The former track of an IMU that was distrusted is led by that IMU
/// alone, and says nothing.
bool is_left_track(const Hypothesis& hypothesis) {
  return hypothesis.track == Track::former && hypothesis.began_ns < hypothesis.explained_ns;
}

/// True for a track that the body may be on although another one is followed: the track that was left, or
/// that of the fixes which are rejected.
bool is_possible_track(const State& state, const Hypothesis& hypothesis) {
  if (is_left_track(hypothesis)) return true;
  return hypothesis.track != Track::followed && hypothesis.track != Track::former &&
         hypothesis.explained >= min_track_fixes && state.fixes.rejected_in_row > 0;
}

/// Share of the best model's noise that the samples do not show: the IMU errs in another way, or the fixes
/// do.
double unexplained_share(const State& state) {
  const auto unexplained = [](double shown, double assumed) { return std::max(0.0, 1.0 - shown / assumed); };
  const ImuModel model = state.bank.best().imu;
  const ProcessNoise& noise = parameters_of(model).noise;
  if (model == ImuModel::rough) return unexplained(state.imu.shocks.density_rthz(), noise.accel_mps2_rthz);
  if (model == ImuModel::rough_gyro) {
    return unexplained(state.imu.turn_shocks.density_rthz(), noise.gyro_radps_rthz);
  }
  return 1.0;
}

/// Variance of the slow errors of the fixes, per axis.
double slow_error_m2(const State& state) {
  return state.slow_error.variance_m2(state.imu.shocks.density_rthz(), state.imu.turn_shocks.density_rthz());
}

/// Variance of an offset between the clocks of IMU and fixes that the best filter does not estimate, if it is
/// unlikely to be chance.
double clock_offset_s2(const State& state) {
  constexpr double sigmas = 2.0;
  const Hypothesis* const other = state.bank.find(ImuModel::other_clock);
  if (other == nullptr) return 0.0;
  const double estimated_s = other == &state.bank.best() ? 0.0 : state.filter().delay_error_s;
  return std::max(0.0, square(other->filter.delay_error_s - estimated_s) -
                           square(sigmas) * other->filter.delay_variance_s2);
}

}  // namespace

bool has_left_track(const State& state) {
  constexpr double apart_m = 0.5;
  return std::any_of(state.bank.begin(), state.bank.end(), [&state](const Hypothesis& each) {
    return is_left_track(each) &&
           (each.filter.tracked_position_world_m() - state.filter().tracked_position_world_m()).norm() >
               apart_m;
  });
}

bool State::is_ambiguous() const {
  if (phase != Phase::tracking) return phase == Phase::searching_yaw;
  if (is_distrustful(bank.best().imu)) return false;
  return bank.best().imu != ImuModel::quiet || imu_fault.mean_innovation_chi2 > chi2_explain_threshold ||
         slow_error_m2(*this) > 0.0 || clock_offset_s2(*this) > 0.0 ||
         std::any_of(bank.begin(), bank.end(), [this](const Hypothesis& each) {
           return (each.track == Track::followed && is_distrustful(each.imu)) ||
                  is_possible_track(*this, each);
         });
}

Spread State::spread() const {
  const bool searches_yaw = phase == Phase::searching_yaw;
  const auto is_possible = [&](const Hypothesis& each) {
    return each.track == Track::followed &&
           (searches_yaw || is_distrustful(each.imu) || &each == &bank.best());
  };
  const auto log_weight = [&](const Hypothesis& each) { return searches_yaw ? each.score : each.evidence; };
  constexpr double track_weight = 0.1;  // most tracks that are not followed are wrong
  constexpr double error_ratio = 3.0;   // both follow the fixes, and so they disagree by less than the error
  constexpr double slow_error_lasts_s = 2.0;
  double max_log_weight = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& each : bank) {
    if (is_possible(each)) max_log_weight = std::max(max_log_weight, log_weight(each));
  }
  Spread spread;
  const double yaw_rad = geometry::yaw_of(filter().q_body_to_world);
  constexpr double no_yaw_rad2 = std::numbers::pi * std::numbers::pi / 3.0;  // variance of a uniform angle
  double weights = 0.0;
  double yaw_rad2 = 0.0;
  for (const Hypothesis& each : bank) {
    const bool is_track = !searches_yaw && is_possible_track(*this, each);
    if (!is_possible(each) && !is_track) continue;
    const double weight = is_track ? track_weight : std::exp(log_weight(each) - max_log_weight);
    weights += weight;
    if (searches_yaw && each.imu == ImuModel::distrusts_imu) {
      yaw_rad2 += weight * no_yaw_rad2;
      continue;
    }
    const double by_rad = geometry::wrap_angle(geometry::yaw_of(each.filter.q_body_to_world) - yaw_rad);
    const Vector3d by_m = each.filter.tracked_position_world_m() - filter().tracked_position_world_m();
    const Vector3d by_mps = each.filter.tracked_velocity_world_mps() - filter().tracked_velocity_world_mps();
    yaw_rad2 += weight * (square(by_rad) + each.filter.yaw_variance_rad2());
    spread.position_m2 += weight * by_m * by_m.transpose();
    spread.velocity_m2ps2 += weight * by_mps * by_mps.transpose();
  }
  yaw_rad2 /= weights;
  spread.position_m2 /= weights;
  spread.velocity_m2ps2 /= weights;
  if (!searches_yaw && imu_fault.mean_innovation_chi2 > chi2_explain_threshold) {
    spread.position_m2 += imu_fault.mean_innovation_world_m * imu_fault.mean_innovation_world_m.transpose();
  }
  if (const Hypothesis* const quiet = searches_yaw ? nullptr : bank.find(ImuModel::quiet)) {
    // Either the IMU errs, or the fixes do for a while.
    yaw_rad2 += square(error_ratio * unexplained_share(*this) *
                       geometry::wrap_angle(geometry::yaw_of(quiet->filter.q_body_to_world) - yaw_rad));
  }
  spread.yaw_rad2 = std::max(0.0, std::min(yaw_rad2, no_yaw_rad2) - filter().yaw_variance_rad2());
  if (searches_yaw) return spread;
  const double slow_m2 = slow_error_m2(*this);
  spread.position_m2 += slow_m2 * Matrix3d::Identity();
  spread.velocity_m2ps2 += slow_m2 / square(slow_error_lasts_s) * Matrix3d::Identity();
  const double clock_s2 = clock_offset_s2(*this);  // either clock may be right
  const Vector3d per_s = filter().tracked_velocity_world_mps();
  const Vector3d per_s2 = filter().acceleration_world_mps2;
  spread.position_m2 += clock_s2 * per_s * per_s.transpose();
  spread.velocity_m2ps2 += clock_s2 * per_s2 * per_s2.transpose();
  return spread;
}

}  // namespace sonopose::estimation::kalman
