#include "evaluation/score/score.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace sonopose::evaluation {
namespace {

constexpr double max_interpolated_s = 0.1;  // over which truth or poses are interpolated
constexpr double none = std::numeric_limits<double>::quiet_NaN();

double root_mean_square(const std::vector<double>& errors) {
  if (errors.empty()) return none;
  double squares = 0.0;
  for (const double error : errors) squares += error * error;
  return std::sqrt(squares / static_cast<double>(errors.size()));
}

template <class Sample>
Sample interpolated(const Sample& before, const Sample& after, TimeNs time_ns) {
  const double share =
      seconds_between(before.time_ns, time_ns) / seconds_between(before.time_ns, after.time_ns);
  Sample sample = before;
  sample.time_ns = time_ns;
  sample.position_world_m += share * (after.position_world_m - before.position_world_m);
  sample.velocity_world_mps += share * (after.velocity_world_mps - before.velocity_world_mps);
  sample.q_body_to_world = before.q_body_to_world.slerp(share, after.q_body_to_world);
  return sample;
}

}  // namespace

ErrorSummary error_summary_of(std::vector<double> errors) {
  if (errors.empty()) return {none, none, none};
  const double rmse = root_mean_square(errors);
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(errors.size()))) - 1;
  const auto p95 = errors.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(errors.begin(), p95, errors.end());
  return {rmse, *p95, *std::max_element(p95, errors.end())};
}

AttitudeError error_of(const Quaterniond& q_estimate, const Quaterniond& q_truth) {
  const Quaterniond off = q_estimate * q_truth.conjugate();
  // The order of arguments keeps NaN: an invalid orientation must not have zero error.
  return {2.0 * std::acos(std::min(std::abs(off.w()), 1.0)),
          2.0 * std::atan2(std::abs(off.z()), std::abs(off.w())),
          2.0 * std::acos(std::min(std::hypot(off.w(), off.z()), 1.0))};
}

std::optional<TruthSample> TruthTrack::at(TimeNs time_ns) {
  if (truth_.empty() || time_ns > truth_.back().time_ns) return std::nullopt;
  while (truth_[next_].time_ns < time_ns) ++next_;
  while (next_ > 0 && truth_[next_ - 1].time_ns >= time_ns) --next_;
  const TruthSample& after = truth_[next_];
  if (after.time_ns == time_ns) return after;
  if (next_ == 0) return std::nullopt;
  const TruthSample& before = truth_[next_ - 1];
  if (seconds_between(before.time_ns, after.time_ns) > max_interpolated_s) return std::nullopt;
  return interpolated(before, after, time_ns);
}

std::optional<TruthSample> TruthTrack::at_or_since(TimeNs before_ns, TimeNs time_ns) {
  if (auto truth = at(time_ns)) return truth;
  if (before_ns >= time_ns || seconds_between(before_ns, time_ns) > max_interpolated_s) return std::nullopt;
  const auto later = std::upper_bound(
      truth_.begin(), truth_.end(), time_ns,
      [](TimeNs searched_ns, const TruthSample& each) { return searched_ns < each.time_ns; });
  if (later == truth_.begin() || std::prev(later)->time_ns <= before_ns) return std::nullopt;
  return *std::prev(later);
}

FusedPose between(const FusedPose& before, const FusedPose& after, TimeNs time_ns) {
  return interpolated(before, after, time_ns);
}

void Scorer::add(const FusedPose& pose) {
  if (pose.time_ns < from_ns_) return;
  const auto truth = track_.at_or_since(before_.time_ns, pose.time_ns);
  if (!truth || !truth->position_world_m.allFinite()) ++without_truth_;
  if (truth) add(truth->time_ns == pose.time_ns ? pose : between(before_, pose, truth->time_ns), *truth);
  before_ = pose;
}

void Scorer::add(const FusedPose& pose, const TruthSample& truth) {
  if (truth.position_world_m.allFinite()) {
    times_ns_.push_back(pose.time_ns);
    position_m_.push_back((pose.position_world_m - truth.position_world_m).norm());
  }
  if (truth.velocity_world_mps.allFinite()) {
    velocity_mps_.push_back((pose.velocity_world_mps - truth.velocity_world_mps).norm());
  }
  if (truth.q_body_to_world.coeffs().allFinite()) {
    const AttitudeError error = error_of(pose.q_body_to_world, truth.q_body_to_world);
    yaw_rad_.push_back(error.heading_rad);
    tilt_rad_.push_back(error.inclination_rad);
  }
}

Score Scorer::score() const {
  return {.poses = position_m_.size(),
          .poses_without_truth = without_truth_,
          .position_m = error_summary_of(position_m_),
          .yaw_rmse_deg = root_mean_square(yaw_rad_) / geometry::radians_per_degree,
          .tilt_rmse_deg = root_mean_square(tilt_rad_) / geometry::radians_per_degree,
          .velocity_rmse_mps = root_mean_square(velocity_mps_),
          .errors_m = position_m_,
          .times_ns = times_ns_};
}

}  // namespace sonopose::evaluation
