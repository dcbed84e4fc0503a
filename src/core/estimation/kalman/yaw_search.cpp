// The first fix, and the search for an unknown yaw: one hypothesis per direction, and one on the fixes alone.

#include "estimation/kalman/state_internal.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sonopose::estimation::kalman {
namespace {

void set_known(Filter& start, const aiding::KnownSensors& known) {
  start.gyro_bias_body_radps = known.gyro_bias_body_radps.value;
  start.accel_bias_body_mps2 = known.accel_bias_body_mps2.value;
  start.lever_arm_body_m = known.lever_arm_body_m.value;
  start.decorrelate(at_gyro_bias, known.gyro_bias_body_radps.std.cwiseAbs2());
  start.decorrelate(at_accel_bias, known.accel_bias_body_mps2.std.cwiseAbs2());
  start.decorrelate(at_lever_arm, known.lever_arm_body_m.std.cwiseAbs2());
}

/// Filter with the biases, lever arm and delay known so far, and the variances of a start except for yaw.
Filter initial_filter(const State& state, bool at_rest) {
  // The attitude of an abandoned estimate is less certain than that from the mean force.
  const double attitude_std_rad = radians(at_rest ? 1.7 : state.phase == Phase::waiting ? 5.0 : 15.0);
  const double speed_std_mps = at_rest ? 0.1 : 2.0;
  Filter start;
  auto variances = start.covariance.diagonal();
  variances.segment<3>(at_position).setConstant(square(0.05));
  variances.segment<3>(at_velocity).setConstant(square(speed_std_mps));
  variances.segment<3>(at_attitude).setConstant(square(attitude_std_rad));
  variances.segment<3>(at_gyro_bias).setConstant(square(start_gyro_bias_std_radps));
  variances.segment<3>(at_accel_bias).setConstant(square(start_accel_bias_std_mps2));
  variances.segment<3>(at_lever_arm).setConstant(square(start_lever_arm_std_m));
  if (state.phase == Phase::waiting) {
    if (state.known) set_known(start, *state.known);
    return start;
  }
  const Filter& before = state.filter();
  start.gyro_bias_body_radps = before.gyro_bias_body_radps;
  start.accel_bias_body_mps2 = before.accel_bias_body_mps2;
  start.lever_arm_body_m = before.lever_arm_body_m;
  start.delay_error_s = before.delay_error_s;
  start.delay_variance_s2 = before.delay_variance_s2;
  if (before.scale) start.scale.push({.error = before.scale->error, .variance = before.scale->variance});
  for (const StateIndex index : {at_gyro_bias, at_accel_bias, at_lever_arm}) {
    start.covariance.block<3, 3>(index, index) = before.covariance.block<3, 3>(index, index);
  }
  return start;
}

/// Starts one hypothesis per direction of the body about `up_body`, from this yaw on, with the tracked point
/// in place. With several directions, another one follows the fixes alone.
void search(State& state, const Filter& from, const Vector3d& up_body, double first_yaw_rad, int directions) {
  const Vector3d tracked_world_m = from.tracked_position_world_m();
  state.phase = Phase::searching_yaw;
  state.bank.clear();
  for (int i = 0; i <= directions; ++i) {
    const bool is_fixes_alone = i == directions;
    if (is_fixes_alone && directions == 1) break;
    Hypothesis& start = state.bank.spawn({.filter = from});
    start.filter.ignores_force = is_fixes_alone;
    if (is_fixes_alone) start.imu = ImuModel::distrusts_imu;
    start.filter.q_body_to_world =
        geometry::level_with(up_body, first_yaw_rad + i * 2.0 * std::numbers::pi / start_count);
    start.filter.position_world_m = tracked_world_m + start.filter.q_body_to_world * from.lever_arm_body_m;
  }
  state.bank.best_index = 0;
}

/// Yaw from the last heading, turned by the gyroscope to the time of a fix.
double yaw_of_last_heading_rad(const State& state, TimeNs fix_ns, const settings::Settings& settings) {
  const double since_sample_s = seconds_between(state.imu.time_ns, fix_ns);
  const double turned_rad =
      since_sample_s < settings.outage.imu_gap_s ? since_sample_s * yaw_rate_radps(state) : 0.0;
  return state.headings.heading_world_rad + turned_rad - radians(settings.heading.mount_offset_deg);
}

}  // namespace

void search_yaw_again(State& state) {
  Filter from = state.filter();
  const bool follows_fixes_alone = state.bank.best().imu == ImuModel::distrusts_imu;
  if (follows_fixes_alone) {
    restore_trusted_biases(state.imu_fault, from);
    level_by_mean_force(state, from);
    forget_judgement(state);
  } else {
    from.decorrelate(at_attitude, Vector3d::Constant(square(radians(5.0))));
  }
  from.add_yaw_variance(square(radians(15.0)));
  search(state, from, geometry::up_in_body(from.q_body_to_world), geometry::yaw_of(from.q_body_to_world),
         start_count);
  if (follows_fixes_alone) state.bank.best_index = start_count;
}

bool restart_search(State& state) {
  const Hypothesis* fixes_alone = nullptr;
  double start_evidence = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& each : state.bank) {
    if (each.track != Track::followed) continue;
    if (each.imu == ImuModel::distrusts_imu) {
      fixes_alone = &each;
    } else {
      start_evidence = std::max(start_evidence, each.evidence);
    }
  }
  if (fixes_alone == nullptr || fixes_alone->explained_in_row < min_track_fixes ||
      fixes_alone->evidence < std::max(start_evidence + min_evidence_margin,
                                       state.imu_fault.shifted.evidence + min_margin_over_tracks))
    return false;
  state.bank.best_index = state.bank.index_of(*fixes_alone);
  search_yaw_again(state);
  return true;
}

void start_at(State& state, const FixMeasurement& fix, const settings::Settings& settings) {
  // What was held back before the start is not made up for after it.
  state.imu.force_spikes.forget_held();
  state.imu.rate_spikes.forget_held();
  state.slow_error = {};
  const bool at_rest = state.rest.still_windows >= 1;
  const Vector3d up_body = at_rest ? state.rest.still_accel_mean
                           : state.phase != Phase::waiting
                               ? geometry::up_in_body(state.filter().q_body_to_world)
                               : state.imu.mean_force_body_mps2;
  const bool has_heading =
      state.headings.is_current && fix.time_ns - state.headings.used_ns < max_heading_age_ns;
  const double yaw_rad = has_heading ? yaw_of_last_heading_rad(state, fix.time_ns, settings) : 0.0;
  Filter start = initial_filter(state, at_rest);
  // Noise of a usual fix, or of this one if larger.
  start.decorrelate(
      at_position,
      covariance_of(state, fix).diagonal().cwiseMax(start.covariance.diagonal().segment<3>(at_position)));
  start.position_world_m = fix.position_world_m + start.q_body_to_world * start.lever_arm_body_m;
  start.angular_velocity_body_radps = state.imu.rate_body_radps;
  search(state, start, up_body, yaw_rad, has_heading ? 1 : start_count);
  const double heading_std_rad = std::max(radians(4.0), state.headings.std_rad);
  for (Hypothesis& each : state.bank) {
    each.filter.position_world_m -= each.filter.q_body_to_world * fix.point_body_m;
    each.filter.add_yaw_variance(square(has_heading ? heading_std_rad : radians(15.0)));
  }
  state.restart_pending = false;
  state.last_zero_velocity_ns = fix.time_ns;
  state.fixes = {.used_ns = fix.time_ns,
                 .since_start = 1,
                 .quality_percent = fix.quality_percent,
                 .point_body_m = state.fixes.point_body_m};
  state.headings.accept();
  if (!has_heading) return;
  state.phase = Phase::tracking;
  state.bank.follow(state.filter());
}

/// Removes starts that fixes and headings contradict, and those that became equal to another one. The best
/// one changes only if another is much more likely: the yaw must not jump while nothing is learned.
void prune_starts(State& state) {
  constexpr double merge_angle_rad = radians(4.0);
  constexpr double min_score_margin = 2.0;
  HypothesisBank& bank = state.bank;
  const auto is_start = [&](const Hypothesis& each) {
    return each.track == Track::followed && each.imu != ImuModel::distrusts_imu;
  };
  const auto yaw_of = [](const Hypothesis& each) { return geometry::yaw_of(each.filter.q_body_to_world); };
  double max_score = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& each : bank) {
    if (is_start(each)) max_score = std::max(max_score, each.score);
  }
  bool has_best = true;
  const auto end = [&](int i) {
    has_best = has_best && i != bank.best_index;
    bank.remove(&bank[i]);
  };
  for (int i = bank.size() - 1; i >= 0; --i) {
    if (!is_start(bank[i])) continue;
    if (!(bank[i].score > max_score - max_start_score_deficit && bank[i].filter.is_finite())) {
      end(i);
      continue;
    }
    for (int j = 0; j < i; ++j) {
      const double apart_rad = std::abs(geometry::wrap_angle(yaw_of(bank[i]) - yaw_of(bank[j])));
      if (!is_start(bank[j]) || !(apart_rad < merge_angle_rad)) continue;
      if (bank[i].score > bank[j].score) std::swap(bank[i], bank[j]);
      if (bank.best_index == i) bank.best_index = j;
      bank.remove(&bank[i]);
      break;
    }
  }
  const int starts = static_cast<int>(std::count_if(bank.begin(), bank.end(), is_start));
  double min_score =
      has_best ? bank.best().score + min_score_margin : -std::numeric_limits<double>::infinity();
  for (int i = 0; i < bank.size(); ++i) {
    if (bank[i].track != Track::followed || !(bank[i].score > min_score)) continue;
    bank.best_index = i;
    min_score = bank[i].score;
  }
  if (starts > 1) return;
  if (bank.best().imu == ImuModel::distrusts_imu) {
    search_yaw_again(state);
  } else {
    bank.remove(Track::other);  // its yaw is arbitrary
    state.phase = Phase::tracking;
    bank.follow(state.filter());
  }
}

}  // namespace sonopose::estimation::kalman
