// The first fix: one filter, or one per direction from which an unknown yaw is searched.

#include "estimation/kalman/belief_parts.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace sonopose::estimation::kalman {

void Belief::start_at(const FixMeasurement& fix, const settings::Settings& settings) {
  const bool at_rest = rest.still_windows >= 1;
  const Vector3d up = at_rest                   ? rest.still_accel_mean
                      : phase != Phase::waiting ? geometry::up_in_body(filter().q_body_to_world)
                                                : mean_force_body_mps2;
  const Filter start = initial_filter(at_rest);
  const bool has_heading = heading_is_current && fix.time_ns - last_heading_ns < heading_kept_ns;
  const double first_yaw_rad = has_heading ? yaw_of_last_heading_rad(fix.time_ns, settings) : 0.0;
  const double yaw_std_rad = has_heading ? radians(4.0) : radians(15.0);
  // That of a usual fix, or of this one where it is larger.
  const Vector3d position_variance_m2 =
      covariance_of(fix).diagonal().cwiseMax(start.covariance.diagonal().segment<3>(at_position));
  candidate_count = has_heading ? 1 : most_candidates;
  for (int i = 0; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    candidate = Candidate{};
    candidate.filter = start;
    candidate.filter.q_body_to_world =
        geometry::level_with(up, first_yaw_rad + i * 2.0 * std::numbers::pi / start_count);
    candidate.filter.position_world_m =
        fix.position_world_m + candidate.filter.q_body_to_world * start.lever_arm_body_m;
    candidate.filter.angular_velocity_body_radps = rate_body_radps;
    candidate.filter.decorrelate(at_position, position_variance_m2);
    candidate.filter.add_yaw_variance(square(yaw_std_rad));
  }
  best = 0;
  fixes_since_start = 1;
  fixes_rejected_in_row = 0;
  rival.alive = former.alive = false;
  restart_pending = false;
  phase = Phase::searching_yaw;
  trust = 1.0;
  last_fix_ns = fix.time_ns;
  slowed_ns = fix.time_ns;
  heading_rejected_since_ns = 0;
  headings_rejected_in_row = 0;
  quality_percent = fix.quality_percent;
  if (has_heading) adopt(filter());
}

/// A filter with the biases, lever arm and delay known so far, and the variances of a start. `start_at` adds
/// that of the yaw.
Filter Belief::initial_filter(bool at_rest) const {
  // The attitude of an estimate that is given up is less certain than that from the mean force.
  const double attitude_std_rad = radians(at_rest ? 1.7 : phase == Phase::waiting ? 5.0 : 15.0);
  const double speed_std_mps = at_rest ? 0.1 : 2.0;
  Filter start;
  start.covariance.setZero();
  auto variances = start.covariance.diagonal();
  variances.segment<3>(at_position).setConstant(square(0.05));
  variances.segment<3>(at_velocity).setConstant(square(speed_std_mps));
  variances.segment<3>(at_attitude).setConstant(square(attitude_std_rad));
  variances.segment<3>(at_gyro_bias).setConstant(square(start_gyro_bias_std_radps));
  variances.segment<3>(at_accel_bias).setConstant(square(start_accel_bias_std_mps2));
  variances.segment<3>(at_lever_arm).setConstant(square(start_lever_arm_std_m));
  if (phase == Phase::waiting) return start;
  const Filter& before = filter();
  start.gyro_bias_body_radps = before.gyro_bias_body_radps;
  start.accel_bias_body_mps2 = before.accel_bias_body_mps2;
  start.lever_arm_body_m = before.lever_arm_body_m;
  start.delay_error_s = before.delay_error_s;
  start.delay_variance_s2 = before.delay_variance_s2;
  for (const StateIndex index : {at_gyro_bias, at_accel_bias, at_lever_arm}) {
    start.covariance.block<3, 3>(index, index) = before.covariance.block<3, 3>(index, index);
  }
  return start;
}

/// The yaw from the last heading, turned by the gyro to the time of a fix.
double Belief::yaw_of_last_heading_rad(TimeNs fix_ns, const settings::Settings& settings) const {
  const double since_sample_s = seconds_between(time_ns, fix_ns);
  const double turned_rad =
      since_sample_s < settings.outage.imu_gap_s ? since_sample_s * up_rate_radps() : 0.0;
  return last_heading_rad + turned_rad - radians(settings.heading.mount_offset_deg);
}

/// One filter per noise model, all on this track.
void Belief::adopt(const Filter& track) {
  // `track` may be one of the candidates: each assignment leaves its value as it is.
  phase = Phase::tracking;
  candidate_count = closed_count;
  for (int i = 0; i < closed_count; ++i) {
    candidates[static_cast<std::size_t>(i)] = Candidate{.filter = track};
  }
  best = std::min(best, closed_count - 1);
  suspicious_until_ns = 0;
}

/// Removes starts that the fixes and headings contradict, and those that became equal to another one. The
/// best candidate changes only if another is much more likely: the yaw must not jump while nothing is
/// learned.
void Belief::prune_starts() {
  constexpr double contradicted = 14.0;
  constexpr double merged_rad = 4.0 * geometry::radians_per_degree;
  constexpr double much_better = 2.0;
  const int starts = start_count_now();
  double most = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < starts; ++i) most = std::max(most, candidates[static_cast<std::size_t>(i)].score);
  int kept = 0;
  int kept_best = -1;
  std::array<double, start_count> kept_yaw_rad{};
  for (int i = 0; i < starts; ++i) {
    const Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    if (!(candidate.score > most - contradicted && candidate.filter.is_finite())) continue;
    const double yaw_rad = geometry::yaw_of(candidate.filter.q_body_to_world);
    const auto end = kept_yaw_rad.begin() + kept;
    const auto equal = std::find_if(kept_yaw_rad.begin(), end, [yaw_rad](double other_rad) {
      return std::abs(geometry::wrap_angle(other_rad - yaw_rad)) < merged_rad;
    });
    const auto place = static_cast<int>(equal - kept_yaw_rad.begin());
    Candidate& other = candidates[static_cast<std::size_t>(place)];
    if (i == best) kept_best = place;
    if (equal == end) {
      ++kept;
    } else if (!(candidate.score > other.score)) {
      continue;
    }
    if (place != i) other = candidate;
    kept_yaw_rad[static_cast<std::size_t>(place)] = yaw_rad;
  }
  if (best == starts) kept_best = kept;
  if (kept != starts)
    candidates[static_cast<std::size_t>(kept)] = candidates[static_cast<std::size_t>(starts)];
  candidate_count = kept + 1;
  best = std::max(kept_best, 0);
  for (int i = 0; i < candidate_count; ++i) {
    const double least =
        candidates[static_cast<std::size_t>(best)].score + (kept_best < 0 ? 0.0 : much_better);
    if (candidates[static_cast<std::size_t>(i)].score > least) best = i;
  }
  if (best == kept) {
    if (kept < 2) search_yaw_again();
  } else if (kept == 1) {
    adopt(filter());
  }
}

/// Starts again in all directions from the filter that follows the fixes alone, where they contradict every
/// start.
void Belief::search_yaw_again() {
  constexpr double attitude_std_rad = radians(5.0);
  constexpr double yaw_std_rad = radians(15.0);
  Filter from = filter();
  const Vector3d up = geometry::up_in_body(from.q_body_to_world);
  from.decorrelate(at_attitude, Vector3d::Constant(square(attitude_std_rad)));
  from.add_yaw_variance(square(yaw_std_rad));
  candidate_count = most_candidates;
  for (int i = 0; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    candidate = {.filter = from};
    candidate.filter.q_body_to_world = geometry::level_with(up, i * 2.0 * std::numbers::pi / start_count);
    candidate.filter.position_world_m =
        from.tracked_position_world_m() + candidate.filter.q_body_to_world * from.lever_arm_body_m;
  }
  best = start_count;
}

Spread Belief::spread() const {
  Spread spread;
  if (phase != Phase::searching_yaw) return spread;
  double most = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < candidate_count; ++i) {
    most = std::max(most, candidates[static_cast<std::size_t>(i)].score);
  }
  const double yaw_rad = geometry::yaw_of(filter().q_body_to_world);
  constexpr double no_yaw_rad2 = std::numbers::pi * std::numbers::pi / 3.0;  // of a uniform angle
  double weights = 0.0;
  double yaw_rad2 = 0.0;
  for (int i = 0; i < candidate_count; ++i) {
    const Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    const double weight = std::exp(candidate.score - most);
    if (i == start_count_now()) {
      yaw_rad2 += weight * no_yaw_rad2;
      weights += weight;
      continue;
    }
    const double by_rad = geometry::wrap_angle(geometry::yaw_of(candidate.filter.q_body_to_world) - yaw_rad);
    const Vector3d by_m = candidate.filter.tracked_position_world_m() - filter().tracked_position_world_m();
    const Vector3d by_mps =
        candidate.filter.tracked_velocity_world_mps() - filter().tracked_velocity_world_mps();
    weights += weight;
    yaw_rad2 += weight * (square(by_rad) + candidate.filter.yaw_variance_rad2());
    spread.position_m2 += weight * by_m * by_m.transpose();
    spread.velocity_m2ps2 += weight * by_mps * by_mps.transpose();
  }
  spread.yaw_rad2 = std::max(0.0, std::min(yaw_rad2 / weights, no_yaw_rad2) - filter().yaw_variance_rad2());
  spread.position_m2 /= weights;
  spread.velocity_m2ps2 /= weights;
  return spread;
}

}  // namespace sonopose::estimation::kalman
