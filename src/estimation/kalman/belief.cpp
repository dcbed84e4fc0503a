#include <sonopose/estimation/kalman/belief.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sonopose::estimation::kalman {
namespace {

constexpr double full_weight_below = 7.8;  // χ², 3 degrees of freedom: 5 % are above
constexpr double rejected_above = 30.0;
constexpr TimeNs converging_ns = 500'000'000;  // after a jump
constexpr double former_s = 8.0;               // for which a track that was given up is kept
constexpr double heading_full_below = 6.6;
constexpr double heading_rejected_above = 25.0;

constexpr std::array<ProcessNoise, model_count> models{
    ProcessNoise{}, ProcessNoise{.gyro_radps_rthz = 12 * 2e-4, .gyro_bias_radps_rts = 1e-3},
    ProcessNoise{.accel_mps2_rthz = 50 * 0.003, .gyro_radps_rthz = 12 * 2e-4}};

double square(double x) {
  return x * x;
}

double radians(double degrees) {
  return degrees * geometry::radians_per_degree;
}

/// Student's t with six degrees of freedom over three dimensions, up to a constant.
double log_likelihood(const Innovation& innovation) {
  return -4.5 * std::log1p(innovation.squared_norm / 6.0) - 0.5 * innovation.log_determinant;
}

}  // namespace

void Belief::copy_from(const Belief& other) {
  phase = other.phase;
  time_ns = other.time_ns;
  rate_body_radps = other.rate_body_radps;
  force_body_mps2 = other.force_body_mps2;
  mean_force_body_mps2 = other.mean_force_body_mps2;
  in_imu_gap = other.in_imu_gap;
  restart_pending = other.restart_pending;
  rest = other.rest;
  noise = other.noise;
  repetition = other.repetition;
  best = other.best;
  candidate_count = other.candidate_count;
  std::copy_n(other.candidates.begin(), candidate_count, candidates.begin());
  if (other.rival.alive) {
    rival = other.rival;
  } else {
    rival.alive = false;
  }
  if (other.former.alive) {
    former = other.former;
  } else {
    former.alive = false;
  }
  last_fix_ns = other.last_fix_ns;
  last_heading_ns = other.last_heading_ns;
  last_heading_rad = other.last_heading_rad;
  heading_rejected_since_ns = other.heading_rejected_since_ns;
  heading_rejected_ns = other.heading_rejected_ns;
  headings_rejected_in_row = other.headings_rejected_in_row;
  quality_percent = other.quality_percent;
  converging_until_ns = other.converging_until_ns;
  slowed_ns = other.slowed_ns;
  trust = other.trust;
}

template <class Visit>
void Belief::for_each_filter(const Visit& visit) {
  for (int i = 0; i < candidate_count; ++i) {
    const int model = phase == Phase::tracking ? i : 0;
    visit(candidates[static_cast<std::size_t>(i)].filter, models[static_cast<std::size_t>(model)]);
  }
  const auto& best_model = models[static_cast<std::size_t>(phase == Phase::tracking ? best : 0)];
  if (rival.alive) visit(rival.filter, best_model);
  if (former.alive) visit(former.filter, best_model);
}

void Belief::propagate() {
  for_each_filter([](Filter& each, const ProcessNoise& model) { each.propagate(model); });
}

// One IMU sample

void Belief::on_imu(const settings::Settings& settings, const ImuMeasurement& imu) {
  const double dt_s = time_ns == 0 ? 0.0 : seconds_between(time_ns, imu.time_ns);
  in_imu_gap = time_ns != 0 && dt_s > settings.outage.imu_gap_s;
  const bool is_first = time_ns == 0;
  const Vector3d rate =
      imu.is_mean || is_first ? imu.rate_body_radps : 0.5 * (rate_body_radps + imu.rate_body_radps);
  const Vector3d force =
      imu.is_mean || is_first ? imu.force_body_mps2 : 0.5 * (force_body_mps2 + imu.force_body_mps2);
  if (phase == Phase::waiting) {
    constexpr double time_constant_s = 0.5;
    const double share = time_ns == 0 ? 1.0 : std::min(1.0, std::max(dt_s, 0.005) / time_constant_s);
    mean_force_body_mps2 += share * (imu.force_body_mps2 - mean_force_body_mps2);
  } else if (in_imu_gap) {
    coast_over_gap(dt_s);
  } else if (dt_s > 0.0) {
    for_each_filter([&](Filter& each, const ProcessNoise&) { each.predict(rate, force, dt_s); });
    repetition.moved_world_m += dt_s * repetition.velocity_world_mps;
    repetition.velocity_world_mps += dt_s * filter().acceleration_world_mps2;
    constexpr double regular_step_s = 0.025;
    if (!imu.is_mean && dt_s > regular_step_s) {
      // The mean of the two ends is not that of what lies between.
      const double accel = dt_s * (0.3 * (imu.force_body_mps2 - force_body_mps2).norm() + 0.3);
      const double turn = dt_s * (0.3 * (imu.rate_body_radps - rate_body_radps).norm() + 0.03);
      propagate();
      for_each_filter([&](Filter& each, const ProcessNoise&) {
        each.add_variance(at_velocity, Vector3d::Constant(square(accel)));
        each.add_variance(at_position, Vector3d::Constant(square(0.5 * accel * dt_s)));
        each.add_variance(at_attitude, Vector3d::Constant(square(turn)));
      });
    }
  }
  time_ns = imu.time_ns;
  rate_body_radps = imu.rate_body_radps;
  force_body_mps2 = imu.force_body_mps2;
  update_rest(imu);
  bound_dead_reckoning();
  if (former.alive && seconds_between(former.left_ns, time_ns) > former_s) former.alive = false;
}

/// The motion during the gap is unknown. After a short one the filters go on with more uncertainty; after a
/// long one the next fix starts them again.
void Belief::coast_over_gap(double dt_s) {
  constexpr double long_gap_s = 0.5;
  constexpr double slowing_s = 1.0;
  const double speed = std::min(1.5 * dt_s, 3.0);
  propagate();
  for_each_filter([&](Filter& each, const ProcessNoise& model) {
    each.coast(dt_s, slowing_s);
    each.propagate(model);
    each.add_variance(at_velocity, Vector3d::Constant(square(speed)));
    each.add_variance(at_position, Vector3d::Constant(square(speed * dt_s) / 3.0));
    each.add_variance(at_attitude, Vector3d::Constant(square(std::min(0.1 * dt_s, 0.2))));
    each.add_yaw_variance(square(std::min(0.6 * dt_s, 1.5)));
  });
  if (dt_s > long_gap_s) restart_pending = true;
  rival.alive = former.alive = false;
  rest::restart(rest);
  repetition = Repetition{};
}

/// Whether the IMU was silent between its latest sample and a measurement, which is then no correction of a
/// known motion.
bool Belief::is_beyond_imu(const settings::Settings& settings, TimeNs measured_ns) const {
  return seconds_between(time_ns, measured_ns) > settings.outage.imu_gap_s;
}

void Belief::update_rest(const ImuMeasurement& imu) {
  const bool started = phase != Phase::waiting;
  const Vector3d bias = started ? filter().gyro_bias_body_radps : Vector3d::Zero();
  const double bias_std_radps =
      started ? std::sqrt(filter().covariance.diagonal().segment<3>(at_gyro_bias).maxCoeff()) : 0.02;
  if (!rest::update(rest, imu.time_ns, imu.rate_body_radps, imu.force_body_mps2, bias, bias_std_radps) ||
      !started || rest.still_windows < 2)
    return;
  propagate();
  constexpr double mean_rate_std_radps = 3e-4;  // of half a second, with a slow residual motion
  constexpr double still_speed_std_mps = 0.01;
  for_each_filter([&](Filter& each, const ProcessNoise&) {
    each.correct_states(at_gyro_bias, rest.still_gyro_mean - each.gyro_bias_body_radps,
                        square(mean_rate_std_radps));
  });
  const double fix_std_m = std::sqrt(noise.fix_covariance_m2(quality_percent).diagonal().maxCoeff());
  if (!rest::fixes_stand_still(rest, fix_std_m) || filter().velocity_world_mps.norm() > 0.1) return;
  for (int i = 0; i < candidate_count; ++i) {
    Filter& each = candidates[static_cast<std::size_t>(i)].filter;
    each.correct_states(at_velocity, -each.velocity_world_mps, square(still_speed_std_mps));
  }
}

/// Without fixes a weak measurement of no velocity.
void Belief::bound_dead_reckoning() {
  constexpr TimeNs after_ns = 1'000'000'000;
  constexpr TimeNs period_ns = 100'000'000;
  // The rougher the IMU that the fixes showed, the sooner its integral is worth nothing.
  constexpr std::array<double, model_count> speed_mps_rts{1.5, 1.0, 0.3};
  const auto model = static_cast<std::size_t>(phase == Phase::tracking ? best : 0);
  if (phase == Phase::waiting || time_ns - last_fix_ns < after_ns || time_ns - slowed_ns < period_ns) return;
  slowed_ns = time_ns;
  propagate();
  for (int i = 0; i < candidate_count; ++i) {
    Filter& each = candidates[static_cast<std::size_t>(i)].filter;
    each.correct_states(at_velocity, -each.velocity_world_mps,
                        square(speed_mps_rts[model]) / (1e-9 * static_cast<double>(period_ns)));
  }
}

// The first fix

void Belief::start_at(const FixMeasurement& fix, const settings::Settings& settings) {
  const bool at_rest = rest.still_windows >= 1;
  const bool again = phase != Phase::waiting;
  Filter start;
  const Vector3d up = at_rest ? rest.still_accel_mean
                      : again ? geometry::up_in_body(filter().q_body_to_world)
                              : mean_force_body_mps2;
  const double tilt_std = at_rest ? radians(1.7) : radians(5.0);
  const double speed_std = at_rest ? 0.1 : 2.0;
  start.covariance.setZero();
  auto variances = start.covariance.diagonal();
  variances.segment<3>(at_position).setConstant(square(0.05));
  variances.segment<3>(at_velocity).setConstant(square(speed_std));
  variances.segment<3>(at_attitude).setConstant(square(tilt_std));
  variances.segment<3>(at_gyro_bias).setConstant(square(0.02));
  variances.segment<3>(at_accel_bias).setConstant(square(0.1));
  variances.segment<3>(at_lever_arm).setConstant(square(0.05));
  if (again) {
    const Filter& before = filter();
    start.gyro_bias_body_radps = before.gyro_bias_body_radps;
    start.accel_bias_body_mps2 = before.accel_bias_body_mps2;
    start.lever_arm_body_m = before.lever_arm_body_m;
    for (const StateIndex index : {at_gyro_bias, at_accel_bias, at_lever_arm}) {
      start.covariance.block<3, 3>(index, index) = before.covariance.block<3, 3>(index, index);
    }
  }

  constexpr TimeNs recent_ns = 500'000'000;
  const bool has_heading = last_heading_ns != 0 && fix.time_ns - last_heading_ns < recent_ns;
  candidate_count = has_heading ? 1 : start_count;
  const double yaw_std = has_heading ? radians(4.0) : radians(15.0);
  const double first_yaw = has_heading ? last_heading_rad - radians(settings.heading.mount_offset_deg) : 0.0;
  for (int i = 0; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    candidate = Candidate{};
    candidate.filter = start;
    candidate.filter.q_body_to_world =
        geometry::level_with(up, first_yaw + i * 2.0 * std::numbers::pi / start_count);
    candidate.filter.position_world_m =
        fix.position_world_m + candidate.filter.q_body_to_world * start.lever_arm_body_m;
    candidate.filter.angular_velocity_body_radps = rate_body_radps;
    candidate.filter.add_yaw_variance(square(yaw_std));
  }
  best = 0;
  rival.alive = former.alive = false;
  restart_pending = false;
  phase = Phase::searching_yaw;
  trust = 1.0;
  last_fix_ns = fix.time_ns;
  slowed_ns = fix.time_ns;
  heading_rejected_since_ns = 0;
  headings_rejected_in_row = 0;
  quality_percent = fix.quality_percent;
  if (has_heading) begin_tracking();
}

/// One filter per noise model, all as the best start.
void Belief::begin_tracking() {
  const Filter start = filter();
  phase = Phase::tracking;
  adopt(start);
}

void Belief::adopt(const Filter& track) {
  // `track` may be one of the candidates: each assignment leaves its value as it is.
  candidate_count = model_count;
  for (int i = 0; i < model_count; ++i) {
    candidates[static_cast<std::size_t>(i)] = Candidate{.filter = track};
  }
  best = std::min(best, model_count - 1);
}

// One fix

FixOutcome Belief::on_fix(const settings::Settings& settings, const FixMeasurement& fix) {
  FixOutcome outcome;
  if (time_ns == 0) return outcome;
  if (phase != Phase::waiting && is_beyond_imu(settings, fix.time_ns)) {
    outcome.flags = fix_invalid;
    return outcome;
  }
  propagate();
  if (check_frozen(settings.frozen, fix)) {
    outcome.flags = fix_frozen;
    return outcome;
  }
  if (phase == Phase::waiting || restart_pending) {
    outcome.flags = fix_used | (phase == Phase::waiting ? fix_first : fix_stale_recovered);
    start_at(fix, settings);
    outcome.weight = 1.0;
    return outcome;
  }
  const Vector3d position_before = filter().tracked_position_world_m();
  const Vector3d velocity_before = filter().tracked_velocity_world_mps();
  const double yaw_before = geometry::yaw_of(filter().q_body_to_world);
  outcome = judge(fix);
  recover_if_not_finite();
  outcome.jump_world_m = filter().tracked_position_world_m() - position_before;
  outcome.velocity_change_world_mps = filter().tracked_velocity_world_mps() - velocity_before;
  outcome.yaw_change_rad = geometry::wrap_angle(geometry::yaw_of(filter().q_body_to_world) - yaw_before);
  return outcome;
}

/// Nothing can be learned from numbers that are not finite: the next fix starts the estimate.
void Belief::recover_if_not_finite() {
  if (phase == Phase::waiting || filter().is_finite()) return;
  candidates[0] = Candidate{};
  candidate_count = 0;
  best = 0;
  rival.alive = former.alive = false;
  mean_force_body_mps2 = force_body_mps2;
  phase = Phase::waiting;
}

FixOutcome Belief::judge(const FixMeasurement& fix) {
  FixOutcome outcome;
  const double ahead_s = seconds_between(time_ns, fix.time_ns);
  const Matrix3d covariance =
      fix.has_covariance ? fix.covariance_world_m2 : noise.fix_covariance_m2(fix.quality_percent);
  if (phase == Phase::searching_yaw) {
    // The start that explains this fix best speaks for all of them.
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < candidate_count; ++i) {
      const auto& candidate = candidates[static_cast<std::size_t>(i)];
      const double d =
          candidate.filter.fix_innovation(fix.position_world_m, covariance, ahead_s).squared_norm;
      if (d < least) {
        least = d;
        best = i;
      }
    }
  }
  Candidate& chosen = candidates[static_cast<std::size_t>(best)];
  outcome.innovation = chosen.filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
  outcome.has_innovation = true;
  const double d = outcome.innovation.squared_norm;
  outcome.test_ratio = d / rejected_above;
  constexpr double trust_memory = 8.0;
  if (!(d <= rejected_above)) {
    trust -= trust / trust_memory;
    reject(fix, covariance, ahead_s, outcome);
    return outcome;
  }
  trust += (1.0 - trust) / trust_memory;
  const double scale = std::max(1.0, d / full_weight_below);
  outcome.weight = 1.0 / scale;
  outcome.flags = fix_used;
  if (rival.alive) {
    // The rival lives on rejected fixes alone; one that only explains the same track is none.
    constexpr TimeNs idle_ns = 1'500'000'000;
    if (fix.time_ns - rival.last_fix_ns > idle_ns) rival.alive = false;
  }
  former.fixes_in_row = 0;
  correct_candidates(fix, covariance, scale, ahead_s);
  last_fix_ns = fix.time_ns;
  quality_percent = fix.quality_percent;
  slowed_ns = std::max(slowed_ns, fix.time_ns);
  rest::add_fix(rest, fix.time_ns, fix.position_world_m);
  return outcome;
}

void Belief::correct_candidates(const FixMeasurement& fix, const Matrix3d& covariance, double scale,
                                double ahead_s) {
  constexpr double forgetting = 1.0 / 60.0;
  for (int i = 0; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    const Innovation innovation = candidate.filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
    if (phase == Phase::tracking) candidate.score *= 1.0 - forgetting;
    candidate.score += log_likelihood(innovation);
    const bool rejected = phase == Phase::tracking && innovation.squared_norm > 2.0 * rejected_above;
    candidate.rejected_in_row = rejected ? candidate.rejected_in_row + 1 : 0;
    if (!rejected) candidate.filter.correct_fix(fix.position_world_m, scale * covariance, ahead_s);
  }
  if (phase == Phase::searching_yaw) {
    prune_starts();
    return;
  }
  choose_model();
  if (fix.has_covariance) return;
  const Innovation after = filter().fix_innovation(fix.position_world_m, covariance, ahead_s);
  noise.add_fix(fix.quality_percent, after.value, (after.covariance - covariance).diagonal());
}

void Belief::choose_model() {
  constexpr double advantage = 2.0;
  constexpr int lost_after = 6;
  for (int i = 0; i < model_count; ++i) {
    const Candidate& chosen = candidates[static_cast<std::size_t>(best)];
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    if (i != best && candidate.rejected_in_row >= lost_after) {
      candidate = chosen;
      candidate.score = chosen.score - advantage;
    }
    if (candidate.score > chosen.score + advantage) best = i;
  }
}

/// Removes starts that the fixes and headings contradict, and those that became equal to a better one.
void Belief::prune_starts() {
  constexpr double contradicted = 14.0;
  constexpr double merged_rad = 4.0 * geometry::radians_per_degree;
  double most = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < candidate_count; ++i) {
    most = std::max(most, candidates[static_cast<std::size_t>(i)].score);
  }
  int kept = 0;
  for (int i = 0; i < candidate_count; ++i) {
    const Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    bool keep = candidate.score > most - contradicted && candidate.filter.is_finite();
    const double yaw = geometry::yaw_of(candidate.filter.q_body_to_world);
    for (int j = 0; j < kept && keep; ++j) {
      Candidate& other = candidates[static_cast<std::size_t>(j)];
      if (std::abs(geometry::wrap_angle(geometry::yaw_of(other.filter.q_body_to_world) - yaw)) < merged_rad) {
        if (candidate.score > other.score) other = candidate;
        keep = false;
      }
    }
    if (keep) {
      if (kept != i) candidates[static_cast<std::size_t>(kept)] = candidate;
      ++kept;
    }
  }
  candidate_count = kept;
  best = 0;
  if (kept == 0) {
    candidates[0].filter.position_world_m.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;  // none is finite: recover_if_not_finite starts again
  }
  for (int i = 1; i < kept; ++i) {
    if (candidates[static_cast<std::size_t>(i)].score > candidates[static_cast<std::size_t>(best)].score)
      best = i;
  }
  if (kept == 1) begin_tracking();
}

// Wrong tracks

void Belief::reject(const FixMeasurement& fix, const Matrix3d& covariance, double ahead_s,
                    FixOutcome& outcome) {
  outcome.flags = fix_outlier;
  if (take_back_former(fix, covariance, ahead_s)) {
    outcome.flags = fix_used;
    outcome.weight = 1.0;
    return;
  }
  if (!rival.alive) {
    begin_rival(fix, covariance);
    return;
  }
  const Innovation innovation = rival.filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
  if (!(innovation.squared_norm <= rejected_above)) {
    // A track that many fixes support survives a short spike.
    const int most_misses = 3 + std::min(rival.fixes / 2, 9);
    if (++rival.misses_in_row >= most_misses) begin_rival(fix, covariance);
    return;
  }
  outcome.hypothesis = 1;
  rival.misses_in_row = 0;
  rival.filter.correct_fix(fix.position_world_m,
                           std::max(1.0, innovation.squared_norm / full_weight_below) * covariance, ahead_s);
  rival.last_fix_ns = fix.time_ns;
  ++rival.fixes;
  const double jump_m =
      (rival.filter.tracked_position_world_m() - filter().tracked_position_world_m()).norm();
  const double needed_s =
      map_has_turned(fix.time_ns) ? 1.0 : std::clamp(2.2 - (jump_m - 1.5) / 0.5 * 1.2, 1.0, 2.2);
  const double alone_s = seconds_between(std::max(last_fix_ns, rival.began_ns), fix.time_ns);
  const bool enough_fixes = rival.fixes >= 8 || (rival.fixes >= 3 && alone_s > 3.0);
  if (alone_s < needed_s || !enough_fixes) return;
  promote_rival();
  last_fix_ns = fix.time_ns;
  outcome.flags = fix_used | fix_stuck_forced;
  outcome.weight = 1.0;
}

/// The track through this fix with the motion of the best filter; where no track has explained the fixes for
/// a while, with an unknown motion.
void Belief::begin_rival(const FixMeasurement& fix, const Matrix3d& covariance) {
  constexpr double lost_s = 1.0;
  rival.alive = true;
  rival.began_ns = fix.time_ns;
  rival.last_fix_ns = fix.time_ns;
  rival.fixes = 1;
  rival.misses_in_row = 0;
  const bool open = seconds_between(last_fix_ns, fix.time_ns) > lost_s || map_has_turned(fix.time_ns);
  rival.filter = filter();
  Filter& f = rival.filter;
  f.position_world_m = fix.position_world_m + f.q_body_to_world * f.lever_arm_body_m;
  f.open_up(at_position, 2.0 * covariance.diagonal());
  if (!open) return;
  f.open_up(at_velocity, Vector3d::Constant(square(2.0)));
  f.add_variance(at_attitude, Vector3d::Constant(square(radians(5.0))));
  f.add_yaw_variance(square(radians(15.0)));
  f.add_variance(at_gyro_bias, Vector3d::Constant(square(0.01)));
  f.add_variance(at_accel_bias, Vector3d::Constant(square(0.1)));
}

void Belief::promote_rival() {
  // A track that replaced the former a moment ago is less credible than the former itself.
  constexpr double established_s = 4.0;
  const bool keep_former = former.alive && seconds_between(former.left_ns, rival.last_fix_ns) < established_s;
  if (!keep_former) {
    former.alive = true;
    former.left_ns = rival.last_fix_ns;
    former.fixes_in_row = 0;
    former.filter = filter();
  }
  adopt(rival.filter);
  if (map_has_turned(rival.last_fix_ns)) {
    for_each_filter([](Filter& each, const ProcessNoise&) { each.add_yaw_variance(square(radians(40.0))); });
    heading_rejected_since_ns = 0;
    headings_rejected_in_row = 0;
  }
  phase = Phase::tracking;
  rival.alive = false;
  converging_until_ns = time_ns + converging_ns;
  rest::restart(rest);
}

/// Whether the third fix in a row lies on the track that was given up, which is then followed again.
bool Belief::take_back_former(const FixMeasurement& fix, const Matrix3d& covariance, double ahead_s) {
  constexpr int enough = 3;
  if (!former.alive) return false;
  const Innovation innovation = former.filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
  if (!(innovation.squared_norm <= rejected_above)) {
    former.fixes_in_row = 0;
    return false;
  }
  former.filter.correct_fix(fix.position_world_m, covariance, ahead_s);
  if (++former.fixes_in_row < enough) return false;
  adopt(former.filter);
  former.alive = false;
  rival.alive = false;
  last_fix_ns = fix.time_ns;
  converging_until_ns = time_ns + converging_ns;
  rest::restart(rest);
  return true;
}

// Frozen track

/// Whether the coordinates only repeat while the IMU measures a motion.
bool Belief::check_frozen(const settings::FrozenSettings& settings, const FixMeasurement& fix) {
  constexpr double same_coordinate_m = 0.0005;  // half the finest resolution of a beacon
  const auto begin_window = [&] {
    repetition.began_ns = time_ns;
    repetition.moved_world_m.setZero();
    repetition.velocity_world_mps =
        phase == Phase::waiting ? Vector3d::Zero() : filter().tracked_velocity_world_mps();
  };
  const bool repeated =
      repetition.has_fix &&
      (fix.position_world_m - repetition.coordinates_world_m).cwiseAbs().maxCoeff() < same_coordinate_m;
  if (!repeated) {
    repetition.has_fix = true;
    repetition.frozen = false;
    repetition.repeats = 0;
    repetition.coordinates_world_m = fix.position_world_m;
    begin_window();
    return false;
  }
  ++repetition.repeats;
  if (repetition.frozen) return true;
  repetition.frozen =
      repetition.repeats >= settings.repeats && repetition.moved_world_m.norm() > settings.moved_m;
  if (repetition.frozen) {
    // The repeated fixes before the detection slowed the filters down.
    const Vector3d lost_mps = repetition.velocity_world_mps - filter().tracked_velocity_world_mps();
    const Vector3d lost_m =
        repetition.coordinates_world_m + repetition.moved_world_m - filter().tracked_position_world_m();
    for (int i = 0; i < candidate_count; ++i) {
      Filter& each = candidates[static_cast<std::size_t>(i)].filter;
      each.velocity_world_mps += lost_mps;
      each.position_world_m += lost_m;
      each.add_variance(at_velocity, Vector3d::Constant(square(0.3)));
      each.add_variance(at_position, Vector3d::Constant(square(0.1)));
    }
    rival.alive = false;
  } else if (seconds_between(repetition.began_ns, time_ns) > settings.window_s) {
    begin_window();
  }
  return repetition.frozen;
}

// One heading

void Belief::on_heading(const settings::Settings& settings, const HeadingMeasurement& heading) {
  if (phase == Phase::waiting || repetition.frozen || restart_pending ||
      is_beyond_imu(settings, heading.time_ns)) {
    last_heading_ns = heading.time_ns;
    last_heading_rad = heading.heading_world_rad;
    return;
  }
  propagate();
  const double mount_rad = radians(settings.heading.mount_offset_deg);
  const double ahead_s = seconds_between(time_ns, heading.time_ns);
  const double variance = noise.heading_rad2.variance;
  if (phase == Phase::searching_yaw) {
    last_heading_ns = heading.time_ns;
    last_heading_rad = heading.heading_world_rad;
    for (int i = 0; i < candidate_count; ++i) {
      Candidate& candidate = candidates[static_cast<std::size_t>(i)];
      const auto innovation =
          candidate.filter.heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
      if (!innovation.observable) continue;
      const double d = square(innovation.value_rad) / innovation.variance_rad2;
      candidate.score += -3.5 * std::log1p(d / 6.0) - 0.5 * std::log(innovation.variance_rad2);
      candidate.filter.correct_heading(heading.heading_world_rad, mount_rad,
                                       std::max(1.0, d / heading_full_below) * variance, ahead_s);
    }
    prune_starts();
    recover_if_not_finite();
    return;
  }
  const auto innovation =
      filter().heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
  if (!innovation.observable) return;
  const double d = square(innovation.value_rad) / innovation.variance_rad2;
  const bool rejected = d > heading_rejected_above;
  if (rejected && !reject_heading(heading.time_ns)) return;
  heading_rejected_since_ns = 0;
  headings_rejected_in_row = 0;
  last_heading_ns = heading.time_ns;
  last_heading_rad = heading.heading_world_rad;
  for_each_filter([&](Filter& each, const ProcessNoise&) {
    if (rejected) each.add_yaw_variance(square(innovation.value_rad));
    const auto own = each.heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
    const double own_d = square(own.value_rad) / own.variance_rad2;
    each.correct_heading(heading.heading_world_rad, mount_rad,
                         std::max(1.0, own_d / heading_full_below) * variance, ahead_s);
  });
  const auto after = filter().heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
  noise.add_heading(after.value_rad, after.variance_rad2 - variance);
  recover_if_not_finite();
}

/// Registers a rejected heading. True if headings have been rejected for so long that they must be believed.
bool Belief::reject_heading(TimeNs now_ns) {
  constexpr double believed_after_s = 4.0;
  constexpr double run_ends_after_s = 1.0;
  if (heading_rejected_since_ns == 0 || seconds_between(heading_rejected_ns, now_ns) > run_ends_after_s) {
    heading_rejected_since_ns = now_ns;
    headings_rejected_in_row = 0;
  }
  heading_rejected_ns = now_ns;
  ++headings_rejected_in_row;
  return seconds_between(heading_rejected_since_ns, now_ns) >= believed_after_s;
}

/// Whether headings are rejected as well as fixes: a wrong track turns no heading, a turned map does.
bool Belief::map_has_turned(TimeNs now_ns) const {
  constexpr int enough = 2;
  constexpr double recent_s = 1.0;
  return headings_rejected_in_row >= enough && seconds_between(heading_rejected_ns, now_ns) < recent_s;
}

}  // namespace sonopose::estimation::kalman
