#include "estimation/kalman/belief_parts.hpp"
#include "estimation/kalman/filter_parts.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::estimation::kalman {
namespace {

constexpr int still_fixes = 4;  // enough to measure that there is no velocity

/// The rate and acceleration of the latest step, where those of the joined ones are means.
void set_latest(NominalState& state, const Filter& filter, const ImuStep& latest) {
  const Vector3d rate_body_radps = latest.rate_body_radps - filter.gyro_bias_body_radps;
  const Quaterniond q_middle =
      state.q_body_to_world * geometry::rotation_by((-0.5 * latest.duration_s * rate_body_radps).eval());
  state.angular_velocity_body_radps = rate_body_radps;
  state.acceleration_world_mps2 =
      q_middle * (latest.force_body_mps2 - filter.accel_bias_body_mps2) + gravity_world_mps2;
}

/// The nominal state of this filter after these steps.
NominalState moved(const Filter& filter, const JoinedSteps& steps) {
  const ImuStep step = steps.joined();
  NominalState after = filter.step(filter, step.rate_body_radps, step.force_body_mps2, step.duration_s).after;
  if (steps.has_several()) set_latest(after, filter, steps.latest());
  return after;
}

}  // namespace

void Belief::copy_from(const Belief& other) {
  phase = other.phase;
  time_ns = other.time_ns;
  state_ns = other.state_ns;
  rate_body_radps = other.rate_body_radps;
  force_body_mps2 = other.force_body_mps2;
  mean_force_body_mps2 = other.mean_force_body_mps2;
  in_imu_gap = other.in_imu_gap;
  restart_pending = other.restart_pending;
  shocks = other.shocks;
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
  open_steps = other.open_steps;
  wrong_tracks = other.wrong_tracks;
  default_position = other.default_position;
  correlation = other.correlation;
  explanations = other.explanations;
  suspicious_until_ns = other.suspicious_until_ns;
  imu_doubted_until_ns = other.imu_doubted_until_ns;
  imu_doubted_ns = other.imu_doubted_ns;
  imu_doubts = other.imu_doubts;
  trusted_gyro_bias_body_radps = other.trusted_gyro_bias_body_radps;
  trusted_accel_bias_body_mps2 = other.trusted_accel_bias_body_mps2;
  last_fix_ns = other.last_fix_ns;
  fixes_since_start = other.fixes_since_start;
  fixes_rejected_in_row = other.fixes_rejected_in_row;
  usual_step_s = other.usual_step_s;
  last_heading_ns = other.last_heading_ns;
  last_heading_rad = other.last_heading_rad;
  heading_is_current = other.heading_is_current;
  heading_rejected_since_ns = other.heading_rejected_since_ns;
  heading_rejected_ns = other.heading_rejected_ns;
  headings_rejected_in_row = other.headings_rejected_in_row;
  heading_rejected_by_rad = other.heading_rejected_by_rad;
  heading_seen_ns = other.heading_seen_ns;
  heading_interval_s = other.heading_interval_s;
  quality_percent = other.quality_percent;
  converging_until_ns = other.converging_until_ns;
  slowed_ns = other.slowed_ns;
  trust = other.trust;
}

void Belief::propagate() {
  close_steps();
  for_each_filter([](Filter& each, const ProcessNoise& model) { each.propagate(model); });
}

bool Belief::covariance_is_old() const {
  constexpr double longest_s = 0.2;
  return filter().pending.duration_s > longest_s;
}

// One IMU sample

void add_missed_motion(Filter& filter, const ImuStep& step) {
  filter.add_variance(at_velocity, Vector3d::Constant(square(step.velocity_std_mps)));
  filter.add_variance(at_position, Vector3d::Constant(square(step.position_std_m)));
  filter.add_variance(at_attitude, Vector3d::Constant(square(step.attitude_std_rad)));
}

ImuOutcome Belief::on_imu(const settings::Settings& settings, const ImuMeasurement& imu) {
  const bool is_first = time_ns == 0;
  const double dt_s = is_first ? 0.0 : seconds_between(time_ns, imu.time_ns);
  in_imu_gap = dt_s > settings.outage.imu_gap_s;
  if (in_imu_gap) heading_is_current = false;  // no rate shows how the body turned meanwhile
  if (phase == Phase::waiting) {
    constexpr double time_constant_s = 0.5;
    const double share = is_first ? 1.0 : std::min(1.0, std::max(dt_s, 0.005) / time_constant_s);
    mean_force_body_mps2 += share * (imu.force_body_mps2 - mean_force_body_mps2);
  } else if (in_imu_gap) {
    end_imu_gap(imu.time_ns);
  } else if (dt_s > 0.0) {
    ImuStep step = step_between(
        {.time_ns = time_ns, .rate_body_radps = rate_body_radps, .force_body_mps2 = force_body_mps2}, imu,
        usual_step_s);
    step.shock_variance_m2ps2 = shocks.add(imu.force_body_mps2, dt_s);
    predict(step);
    if (step.irregular) {
      propagate();
      for_each_filter([&](Filter& each, const ProcessNoise&) { add_missed_motion(each, step); });
    }
  }
  if (!is_first && !in_imu_gap) {
    usual_step_s = kalman::usual_step_s(usual_step_s, dt_s);
    turn_last_heading(imu);
  }
  time_ns = state_ns = imu.time_ns;
  rate_body_radps = imu.rate_body_radps;
  force_body_mps2 = imu.force_body_mps2;
  ImuOutcome outcome;
  update_rest(imu, outcome);
  bound_dead_reckoning(outcome);
  if (former.alive && seconds_between(former.left_ns, time_ns) > former_s) former.alive = false;
  return outcome;
}

/// The filters join the steps of a fast IMU. Whatever changes them, or needs their state at the latest
/// sample, calls `close_steps`, `propagate` or `nominal` first. `up_rate_radps` need not: a turn hardly
/// changes the component of its own rate about the vertical.
void Belief::predict(const ImuStep& step) {
  if (!can_join(step.duration_s)) close_steps();
  open_steps.add(step);
  if (!can_join(step.duration_s)) close_steps();  // the next one is probably as long
}

/// Whether one more step of this duration can join the open ones: up to 10 ms while tracking, and up to 20 ms
/// while there are many filters, with a margin for the jitter of the stamps.
bool Belief::can_join(double duration_s) const {
  const double longest_s = phase == Phase::searching_yaw ? 0.0205 : 0.0105;
  return open_steps.duration_s() + duration_s <= longest_s;
}

void Belief::close_steps() {
  if (open_steps.empty()) return;
  const ImuStep step = open_steps.joined();
  for_each_filter([&](Filter& each, const ProcessNoise&) {
    each.predict(step.rate_body_radps, step.force_body_mps2, step.duration_s, step.shock_variance_m2ps2);
  });
  repetition.moved_world_m += step.duration_s * repetition.velocity_world_mps;
  repetition.velocity_world_mps += step.duration_s * filter().acceleration_world_mps2;
  Filter& best_filter = candidates[static_cast<std::size_t>(best)].filter;
  if (open_steps.has_several()) set_latest(best_filter, best_filter, open_steps.latest());  // for the pose
  open_steps = JoinedSteps{};
}

NominalState Belief::nominal() const {
  if (open_steps.empty()) return static_cast<const NominalState&>(filter());
  return moved(filter(), open_steps);
}

NominalState Belief::nominal_after(const ImuStep& step) const {
  if (!can_join(step.duration_s)) {
    return filter().step(nominal(), step.rate_body_radps, step.force_body_mps2, step.duration_s).after;
  }
  JoinedSteps steps = open_steps;
  steps.add(step);
  return moved(filter(), steps);
}

/// Of the body about the vertical.
double Belief::up_rate_radps() const {
  if (phase == Phase::waiting) return mean_force_body_mps2.normalized().dot(rate_body_radps);
  return geometry::up_in_body(filter().q_body_to_world).dot(rate_body_radps - filter().gyro_bias_body_radps);
}

/// Keeps the heading of the last pair that of the present while a start may use it.
void Belief::turn_last_heading(const ImuMeasurement& imu) {
  if (!heading_is_current) return;
  if (imu.time_ns - last_heading_ns >= heading_kept_ns) {
    heading_is_current = false;
    return;
  }
  const double before_radps = up_rate_radps();
  rate_body_radps = imu.rate_body_radps;
  last_heading_rad += 0.5 * (before_radps + up_rate_radps()) * seconds_between(time_ns, imu.time_ns);
}

bool Belief::stands_still(int least_fixes) const {
  const Vector3d fix_std_m = noise.fix_covariance_m2(quality_percent).diagonal().cwiseSqrt();
  return rest::fixes_stand_still(rest, fix_std_m, least_fixes);
}

void Belief::update_rest(const ImuMeasurement& imu, ImuOutcome& outcome) {
  if (!rest::add_sample(rest, imu.time_ns, imu.rate_body_radps, imu.force_body_mps2)) return;
  const bool started = phase != Phase::waiting;
  const Vector3d bias = started ? filter().gyro_bias_body_radps : Vector3d::Zero();
  const double bias_std_radps =
      started ? std::sqrt(filter().covariance.diagonal().segment<3>(at_gyro_bias).maxCoeff()) : 0.02;
  const bool still = rest::end_window(rest, imu.time_ns, bias, bias_std_radps);
  if (!still || !started || rest.still_windows < 2) return;
  // A bias that is hardly known may be a slow, smooth turn.
  constexpr double known_bias_radps = 0.005;
  if (bias_std_radps > known_bias_radps &&
      (!stands_still(few_fixes) || rest::headings_turn(rest, std::sqrt(noise.heading_rad2.variance))))
    return;
  propagate();
  outcome.still = true;
  outcome.still_rate_variance = rest::still_rate_variance(rest, imu.time_ns);
  for_each_filter([&](Filter& each, const ProcessNoise&) {
    each.correct_states(at_gyro_bias, rest.still_gyro_mean - each.gyro_bias_body_radps,
                        outcome.still_rate_variance);
  });
  if (!stands_still(still_fixes) || filter().velocity_world_mps.norm() > 0.1) return;
  outcome.no_velocity_variance = rest::still_velocity_variance(rest, imu.time_ns);
  for (int i = 0; i < candidate_count; ++i) {
    Filter& each = candidates[static_cast<std::size_t>(i)].filter;
    each.correct_states(at_velocity, -each.velocity_world_mps, outcome.no_velocity_variance);
  }
}

/// Without fixes a weak measurement of no velocity.
void Belief::bound_dead_reckoning(ImuOutcome& outcome) {
  constexpr TimeNs after_ns = 1'000'000'000;
  constexpr TimeNs period_ns = 97'500'000;  // no multiple of a usual sample interval
  // The rougher the IMU that the fixes showed, the sooner its integral is worth nothing.
  constexpr std::array<double, model_count> speed_mps_rts{1.5, 1.0, 0.3, 0.3, 0.3};
  const auto model = static_cast<std::size_t>(phase == Phase::tracking ? best : 0);
  if (phase == Phase::waiting || time_ns - last_fix_ns < after_ns || time_ns - slowed_ns < period_ns) return;
  slowed_ns = time_ns;
  const double variance = square(speed_mps_rts[model]) / (1e-9 * static_cast<double>(period_ns));
  if (outcome.no_velocity_variance == 0.0) outcome.no_velocity_variance = variance;
  propagate();
  for (int i = 0; i < candidate_count; ++i) {
    Filter& each = candidates[static_cast<std::size_t>(i)].filter;
    each.correct_states(at_velocity, -each.velocity_world_mps, variance);
  }
}

// One fix

FixOutcome Belief::on_fix(const settings::Settings& settings, const FixMeasurement& fix) {
  FixOutcome outcome;
  if (time_ns == 0) return outcome;
  propagate();
  coast_if_silent(settings, fix.time_ns);
  if (default_position.add(fix.time_ns, fix.position_world_m)) {
    // A start at it is none.
    constexpr double near_m = 0.5;
    const bool is_there = phase != Phase::waiting &&
                          (filter().tracked_position_world_m() - fix.position_world_m).norm() < near_m;
    if (fixes_since_start < proven_fixes && is_there) restart_pending = true;
    outcome.flags = fix_outlier;
    return outcome;
  }
  if (check_frozen(settings.frozen, fix)) {
    outcome.flags = fix_frozen;
    return outcome;
  }
  if (phase == Phase::waiting || restart_pending) {
    const bool is_first = phase == Phase::waiting;
    const Vector3d before = is_first ? Vector3d::Zero() : filter().tracked_position_world_m();
    outcome.flags = fix_used | (is_first ? fix_first : fix_stale_recovered);
    start_at(fix, settings);
    if (!is_first) outcome.jump_world_m = filter().tracked_position_world_m() - before;
    outcome.starts = true;
    outcome.weight = 1.0;
    outcome.covariance_world_m2 = covariance_of(fix);
    return outcome;
  }
  estimate_delay(settings.delay);
  const Vector3d position_before = filter().tracked_position_world_m();
  const Vector3d velocity_before = filter().tracked_velocity_world_mps();
  const double yaw_before = geometry::yaw_of(filter().q_body_to_world);
  const bool is_stale = seconds_between(last_fix_ns, fix.time_ns) > settings.outage.stale_after_s;
  outcome = judge(settings, fix);
  suspect_imu(outcome.innovation.squared_norm > explained_below);
  recover_if_not_finite();
  outcome.jump_world_m = filter().tracked_position_world_m() - position_before;
  outcome.velocity_change_world_mps = filter().tracked_velocity_world_mps() - velocity_before;
  outcome.yaw_change_rad = geometry::wrap_angle(geometry::yaw_of(filter().q_body_to_world) - yaw_before);
  if (is_stale && (outcome.flags & fix_used) != 0) outcome.flags |= fix_stale_recovered;
  return outcome;
}

/// Its own, or the learned one.
Matrix3d Belief::covariance_of(const FixMeasurement& fix) const {
  return fix.has_covariance ? fix.covariance_world_m2 : noise.fix_covariance_m2(fix.quality_percent);
}

/// Begins or ends the estimation of the delay, as the settings demand.
void Belief::estimate_delay(const settings::DelaySettings& settings) {
  constexpr double initial_std_s = 0.02;
  if (filter().estimates_delay() == settings.estimate) return;
  for_each_filter([&](Filter& each, const ProcessNoise&) {
    each.estimate_delay(settings.estimate ? square(initial_std_s) : 0.0);
  });
}

/// Nothing can be learned from numbers that are not finite: the next fix starts the estimate.
void Belief::recover_if_not_finite() {
  if (phase == Phase::waiting || filter().is_finite()) return;
  candidates[0] = Candidate{};
  candidate_count = 0;
  best = 0;
  rival.alive = former.alive = false;
  last_heading_ns = 0;  // it was turned with the rate of that filter
  last_heading_rad = 0;
  heading_is_current = false;
  mean_force_body_mps2 = force_body_mps2;
  phase = Phase::waiting;
}

FixOutcome Belief::judge(const settings::Settings& settings, const FixMeasurement& fix) {
  FixOutcome outcome;
  const double ahead_s = seconds_between(state_ns, fix.time_ns);
  const Matrix3d covariance = covariance_of(fix);
  outcome.covariance_world_m2 = covariance;
  const Innovations innovations = innovations_of(fix, covariance, ahead_s);
  const int judge = phase == Phase::searching_yaw ? nearest_start(innovations) : best;
  outcome.innovation = innovations[static_cast<std::size_t>(judge)];
  outcome.has_innovation = true;
  const double d = outcome.innovation.squared_norm;
  outcome.test_ratio = d / rejected_above;
  constexpr double trust_memory = 8.0;
  if (phase == Phase::tracking) explain(fix, covariance, innovations, ahead_s);
  if (!(d <= rejected_above) || rival_explains_better(fix, covariance, ahead_s, outcome.innovation)) {
    trust -= trust / trust_memory;
    ++fixes_rejected_in_row;
    if (phase == Phase::tracking) correct_open(innovations, covariance);
    if (const int model = wrong_sensor(); model != best) {
      doubt_imu(model);
      note_used(fix);
      outcome.flags = fix_used;
      outcome.weight = 1.0;
      return outcome;
    }
    reject(settings, fix, covariance, ahead_s, outcome);
    return outcome;
  }
  trust += (1.0 - trust) / trust_memory;
  const double scale = scale_of(outcome.innovation);
  // After rejected fixes the estimate is uncertain too.
  const Matrix3d more_covariance =
      (scale - 1.0) * (fixes_rejected_in_row > 0 ? outcome.innovation.covariance_m2 : covariance);
  outcome.weight = 1.0 / scale;
  outcome.covariance_world_m2 += more_covariance;
  outcome.flags = fix_used;
  correct_candidates(fix, covariance, more_covariance, innovations, ahead_s);
  note_used(fix);
  return outcome;
}

Belief::Innovations Belief::innovations_of(const FixMeasurement& fix, const Matrix3d& covariance,
                                           double ahead_s) const {
  Innovations innovations;
  for (std::size_t i = 0; i < static_cast<std::size_t>(candidate_count); ++i) {
    innovations[i] = candidates[i].filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
  }
  return innovations;
}

/// The start that explains a fix best.
int Belief::nearest_start(const Innovations& innovations) const {
  const auto nearer = [](const Innovation& a, const Innovation& b) {
    return a.squared_norm < b.squared_norm;
  };
  return static_cast<int>(
      std::min_element(innovations.begin(), innovations.begin() + candidate_count, nearer) -
      innovations.begin());
}

/// Registers a fix that the best filter has used.
void Belief::note_used(const FixMeasurement& fix) {
  fixes_since_start = std::min(fixes_since_start + 1, proven_fixes);
  fixes_rejected_in_row = 0;
  if (rival.alive) {
    // The rival lives on rejected fixes alone; one that only explains the same track is none.
    constexpr TimeNs idle_ns = 1'500'000'000;
    if (fix.time_ns - rival.last_fix_ns > idle_ns) end_rival(fix.time_ns);
    ++rival.fixes_of_best;
  }
  former.fixes_in_row = 0;
  last_fix_ns = fix.time_ns;
  quality_percent = fix.quality_percent;
  slowed_ns = std::max(slowed_ns, fix.time_ns);
  rest::add_fix(rest, fix.time_ns, fix.position_world_m);
  drop_anchor(fix.time_ns);
}

}  // namespace sonopose::estimation::kalman
