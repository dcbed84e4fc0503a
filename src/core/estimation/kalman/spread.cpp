// Uncertainty that the best filter alone does not show.

#include "estimation/kalman/state_internal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sonopose::estimation::kalman {
namespace {

/// Distance of the best filter from the one that trusts the IMU most, if it is another: either the IMU errs,
/// or the fixes do for a while. Both follow the fixes, and so they disagree by less than the error.
Vector3d disagreement_world_m(const HypothesisBank& bank) {
  constexpr double error_ratio = 2.0;
  for (const Hypothesis& each : bank) {
    if (each.track != Track::followed || each.imu != ImuModel::quiet) continue;
    return error_ratio *
           (each.filter.tracked_position_world_m() - bank.best().filter.tracked_position_world_m());
  }
  return Vector3d::Zero();
}

}  // namespace

bool State::is_ambiguous() const {
  if (phase != Phase::tracking) return phase == Phase::searching_yaw;
  if (is_distrustful(bank.best().imu)) return false;
  return bank.best().imu != ImuModel::quiet || imu_fault.mean_innovation_chi2 > chi2_explain_threshold ||
         std::any_of(bank.begin(), bank.end(), [](const Hypothesis& each) {
           return each.track == Track::followed && is_distrustful(each.imu);
         });
}

Spread State::spread() const {
  const bool searches_yaw = phase == Phase::searching_yaw;
  const auto is_possible = [&](const Hypothesis& each) {
    return each.track == Track::followed &&
           (searches_yaw || is_distrustful(each.imu) || &each == &bank.best());
  };
  const auto log_weight = [&](const Hypothesis& each) { return searches_yaw ? each.score : each.evidence; };
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
    if (!is_possible(each)) continue;
    const double weight = std::exp(log_weight(each) - max_log_weight);
    weights += weight;
    if (searches_yaw && each.imu == ImuModel::distrusts_imu) {
      yaw_rad2 += weight * no_yaw_rad2;
      continue;
    }
    const double by_rad = geometry::wrap_angle(geometry::yaw_of(each.filter.q_body_to_world) - yaw_rad);
    const Vector3d by_m = each.filter.tracked_position_world_m() - filter().tracked_position_world_m();
    const Vector3d by_mps = each.filter.tracked_velocity_world_mps() - filter().tracked_velocity_world_mps();
    yaw_rad2 += weight * (square(by_rad) + (searches_yaw ? each.filter.yaw_variance_rad2() : 0.0));
    spread.position_m2 += weight * by_m * by_m.transpose();
    spread.velocity_m2ps2 += weight * by_mps * by_mps.transpose();
  }
  spread.yaw_rad2 = std::min(yaw_rad2 / weights, no_yaw_rad2);
  if (searches_yaw) spread.yaw_rad2 = std::max(0.0, spread.yaw_rad2 - filter().yaw_variance_rad2());
  spread.position_m2 /= weights;
  spread.velocity_m2ps2 /= weights;
  if (!searches_yaw && imu_fault.mean_innovation_chi2 > chi2_explain_threshold) {
    spread.position_m2 += imu_fault.mean_innovation_world_m * imu_fault.mean_innovation_world_m.transpose();
  }
  if (!searches_yaw) {
    const Vector3d by_m = disagreement_world_m(bank);
    spread.position_m2 += by_m * by_m.transpose();
  }
  if (bank.best().imu == ImuModel::other_clock) {  // either clock may be right
    const Vector3d by_m = filter().delay_error_s * filter().tracked_velocity_world_mps();
    spread.position_m2 += by_m * by_m.transpose();
  }
  return spread;
}

}  // namespace sonopose::estimation::kalman
