// State after an IMU sample.

#include "estimation/kalman/filter_internal.hpp"
#include "estimation/kalman/state_internal.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

constexpr int min_zero_velocity_fixes = 4;  // enough to measure that the velocity is zero
constexpr double max_former_age_s = 8.0;    // time for which an abandoned track is kept

/// Sets rate and acceleration of the latest step, since those of joined steps are means.
void set_latest(NominalState& state, const Filter& filter, const ImuStep& latest) {
  const Vector3d rate_body_radps = latest.rate_body_radps - filter.gyro_bias_body_radps;
  const Quaterniond q_middle =
      state.q_body_to_world * geometry::rotation_by((-0.5 * latest.duration_s * rate_body_radps).eval());
  state.angular_velocity_body_radps = rate_body_radps;
  if (filter.ignores_force) return;
  state.acceleration_world_mps2 =
      q_middle * (latest.force_body_mps2 - filter.accel_bias_body_mps2) + gravity_world_mps2;
}

/// Nominal state of this filter after these steps.
NominalState nominal_after_steps(const Filter& filter, const NominalState& from,
                                 const ImuPreintegrator& steps) {
  const ImuStep step = steps.joined();
  NominalState after = filter.step(from, step.rate_body_radps, step.force_body_mps2, step.duration_s).after;
  if (!filter.ignores_force) after.position_world_m += after.q_body_to_world * step.made_up_shift_body_m;
  if (steps.joined_differs()) set_latest(after, filter, steps.latest());
  return after;
}

/// True if another step of this duration can join the pending ones: up to 10 ms while tracking, and up to 20
/// ms while there are many filters, with a margin for the jitter of the stamps.
bool can_join(const State& state, double duration_s) {
  const double max_duration_s = state.phase == Phase::searching_yaw ? 0.0205 : 0.0105;
  return state.imu.pending_steps.duration_s() + duration_s <= max_duration_s;
}

/// Joins the steps of a fast IMU for the filters. Code that changes them, or needs their state at the latest
/// sample, calls `apply_pending_steps`, `propagate` or `nominal` first. `yaw_rate_radps` need not: a turn
/// hardly changes the component of its own rate about the vertical.
void predict(State& state, const ImuStep& step) {
  if (!can_join(state, step.duration_s)) state.apply_pending_steps();
  state.imu.pending_steps.add(step);
  if (!can_join(state, step.duration_s)) state.apply_pending_steps();  // the next one is probably as long
}

/// Direction of the vertical, by the attitude or before the start by the mean force.
Vector3d up_in_body(const State& state) {
  if (state.phase == Phase::waiting) return state.imu.mean_force_body_mps2.normalized();
  return geometry::up_in_body(state.filter().q_body_to_world);
}

/// Keeps the last pair heading up to date while a start may use it.
void turn_last_heading(State& state, const ImuMeasurement& sample, const ImuStep& step) {
  HeadingGate& gate = state.headings;
  if (!gate.is_current) return;
  if (sample.time_ns - gate.used_ns >= max_heading_age_ns) {
    gate.is_current = false;
    return;
  }
  const double before_radps = yaw_rate_radps(state);
  const double dt_s = seconds_between(state.imu.time_ns, sample.time_ns);
  state.imu.rate_body_radps = sample.rate_body_radps;
  gate.heading_world_rad +=
      0.5 * (before_radps + yaw_rate_radps(state)) * dt_s + up_in_body(state).dot(step.made_up_turn_body_rad);
}

/// Updates the mean force. Over some seconds the acceleration of a body that stays in a room averages out, so
/// it shows gravity even if no attitude is known, as long as the gyroscope is right.
void update_mean_force(State& state, const ImuMeasurement& sample, const ImuStep& step, double dt_s) {
  Vector3d& mean = state.imu.mean_force_body_mps2;
  if (dt_s <= 0.0 || state.imu.in_gap) {
    if (mean.isZero() || state.imu.in_gap) mean = sample.force_body_mps2;
    return;
  }
  const bool has_started = state.phase != Phase::waiting;
  const double time_constant_s = has_started ? 3.0 : 0.5;
  Vector3d bias_radps = Vector3d::Zero();
  if (has_started) {
    bias_radps = is_distrustful(state.bank.best().imu) ? state.imu_fault.trusted_gyro_bias_body_radps
                                                       : state.filter().gyro_bias_body_radps;
  }
  const Vector3d turn_rad = dt_s * (sample.rate_body_radps - bias_radps) + step.made_up_turn_body_rad;
  mean = geometry::rotation_by((-turn_rad).eval()) * mean;
  mean += std::min(1.0, dt_s / time_constant_s) * (sample.force_body_mps2 - mean);
}

void update_rest(State& state, const ImuMeasurement& sample, ImuOutcome& outcome) {
  RestState& rest = state.rest;
  if (!rest::add_sample(rest, sample.time_ns, sample.rate_body_radps, sample.force_body_mps2)) return;
  const bool started = state.phase != Phase::waiting;
  const Vector3d bias = started ? state.filter().gyro_bias_body_radps : Vector3d::Zero();
  const double bias_std_radps =
      started ? std::sqrt(state.filter().covariance.diagonal().segment<3>(at_gyro_bias).maxCoeff()) : 0.02;
  const bool still = rest::end_window(rest, sample.time_ns, bias, bias_std_radps);
  if (!still || !started || rest.still_windows < 2) return;
  // If the bias is hardly known, this may be a slow, smooth turn.
  constexpr double known_bias_radps = 0.005;
  if (bias_std_radps > known_bias_radps &&
      (!stands_still(state, min_rest_fixes) ||
       rest::headings_turn(rest, std::sqrt(state.noise.heading_rad2.variance))))
    return;
  state.propagate();
  outcome.still = true;
  outcome.still_rate_variance = rest::still_rate_variance(rest, sample.time_ns);
  for (Hypothesis& each : state.bank) {
    each.filter.update_direct(at_gyro_bias, rest.still_gyro_mean - each.filter.gyro_bias_body_radps,
                              outcome.still_rate_variance);
  }
  if (!stands_still(state, min_zero_velocity_fixes) || state.filter().velocity_world_mps.norm() > 0.1) return;
  outcome.zero_velocity_variance = rest::still_velocity_variance(rest, sample.time_ns);
}

/// Adds the variance of a motion to all filters.
void add_uncertain_motion(State& state, const Vector3d& impulse_body_mps, const Vector3d& turn_body_rad) {
  if (impulse_body_mps.isZero(0.0) && turn_body_rad.isZero(0.0)) return;
  state.propagate();
  for (Hypothesis& each : state.bank) each.filter.add_uncertain_motion(impulse_body_mps, turn_body_rad);
}

/// Adds the variance of a turn beyond the range of the gyroscope.
void add_missed_turn(State& state, const Vector3d& missed_body_radps, double duration_s) {
  constexpr double memory_s = 0.1;  // time for which its rate is alike
  if (missed_body_radps.isZero(0.0)) return;
  state.propagate();
  for (Hypothesis& each : state.bank) {
    each.filter.add_variance(at_attitude, 2.0 * memory_s * duration_s * missed_body_radps.cwiseAbs2());
  }
}

/// Noise of a model: at least what the samples show. `quiet` takes that for a vibration, whose integral is
/// small, and a distrustful model has noise enough.
ProcessNoise process_noise(const ImuInput& imu, ImuModel model) {
  ProcessNoise noise = parameters_of(model).noise;
  if (model == ImuModel::quiet || is_distrustful(model)) return noise;
  noise.accel_mps2_rthz = std::max(noise.accel_mps2_rthz, imu.shocks.density_rthz());
  noise.gyro_radps_rthz = std::max(noise.gyro_radps_rthz, imu.turn_shocks.density_rthz());
  return noise;
}

/// Acceleration by the accelerometer, also for a filter that ignores it: only the IMU shows that the body of
/// a frozen track moves.
Vector3d measured_acceleration_world_mps2(const Filter& filter, const ImuStep& step) {
  if (!filter.ignores_force) return filter.acceleration_world_mps2;
  return filter.q_body_to_world * (step.force_body_mps2 - filter.accel_bias_body_mps2) + gravity_world_mps2;
}

/// Adds a weak measurement of zero velocity while there are no fixes.
void bound_dead_reckoning(State& state, ImuOutcome& outcome) {
  constexpr TimeNs after_ns = 1'000'000'000;
  constexpr TimeNs period_ns = 97'500'000;  // no multiple of a usual sample interval
  const TimeNs now_ns = state.imu.time_ns;
  if (state.phase == Phase::waiting || now_ns - state.fixes.used_ns < after_ns ||
      now_ns - state.last_zero_velocity_ns < period_ns || outcome.zero_velocity_variance > 0.0)
    return;
  state.last_zero_velocity_ns = now_ns;
  outcome.zero_velocity_variance = square(parameters_of(state.bank.best().imu).dead_reckoning_mps_rts) /
                                   (1e-9 * static_cast<double>(period_ns));
}

void update_zero_velocity(State& state, double variance_m2ps2) {
  if (variance_m2ps2 == 0.0) return;
  state.propagate();
  for (Hypothesis& each : state.bank) {
    if (each.track != Track::followed) continue;
    each.filter.update_direct(at_velocity, -each.filter.velocity_world_mps, variance_m2ps2);
  }
}

}  // namespace

bool stands_still(const State& state, int min_fixes) {
  const Vector3d fix_std_m =
      state.noise.fix_covariance_m2(state.fixes.quality_percent).diagonal().cwiseSqrt();
  return rest::fixes_stand_still(state.rest, fix_std_m, min_fixes);
}

double yaw_rate_radps(const State& state) {
  const Vector3d& rate = state.imu.rate_body_radps;
  if (state.phase == Phase::waiting) return up_in_body(state).dot(rate);
  return up_in_body(state).dot(rate - state.filter().gyro_bias_body_radps);
}

void add_missed_motion(Filter& filter, const ImuStep& step) {
  filter.add_variance(at_velocity, Vector3d::Constant(square(step.velocity_std_mps)));
  filter.add_variance(at_position, Vector3d::Constant(square(step.position_std_m)));
  filter.add_variance(at_attitude, Vector3d::Constant(square(step.attitude_std_rad)));
}

AdmittedStep State::step_to(const ImuMeasurement& sample) const {
  const double dt_s = seconds_between(imu.time_ns, sample.time_ns);
  AdmittedStep next{
      .sample = sample, .step = {}, .force_spikes = imu.force_spikes, .rate_spikes = imu.rate_spikes};
  const auto force = next.force_spikes.add(imu.force_body_mps2, sample.force_body_mps2, dt_s, max_jump_mps2);
  const auto rate = next.rate_spikes.add(imu.rate_body_radps, sample.rate_body_radps, dt_s, max_jump_radps);
  next.sample.force_body_mps2 = force.reading_body;
  next.sample.rate_body_radps = rate.reading_body;
  next.step = step_between(imu.latest(), next.sample, imu.nominal_imu_period_s);
  next.step.made_up_impulse_body_mps = force.made_up_body;
  next.step.made_up_shift_body_m = force.made_up_shift_body;
  // The impulse acts over the next step, half of which it should have had before. The means of both ends of
  // the steps have this already.
  if (sample.is_mean) next.step.made_up_shift_body_m += 0.5 * dt_s * force.made_up_body;
  next.step.made_up_turn_body_rad = rate.made_up_body;
  next.dropped_impulse_body_mps = force.dropped_body;
  next.dropped_turn_body_rad = rate.dropped_body;
  return next;
}

ImuOutcome State::on_imu(const settings::Settings& settings, const ImuMeasurement& measured) {
  const bool is_first = imu.time_ns == 0;
  const double dt_s = is_first ? 0.0 : seconds_between(imu.time_ns, measured.time_ns);
  imu.in_gap = dt_s > settings.outage.imu_gap_s || is_repetition(measured);
  if (!is_first) imu.repeats.add(imu.latest(), measured);
  const bool has_step = !imu.in_gap && dt_s > 0.0;
  if (imu.in_gap) {
    imu.force_spikes.forget_held();
    imu.rate_spikes.forget_held();
  }
  const AdmittedStep next = is_first || imu.in_gap ? AdmittedStep{.sample = measured,
                                                                  .step = {},
                                                                  .force_spikes = imu.force_spikes,
                                                                  .rate_spikes = imu.rate_spikes}
                                                   : step_to(measured);
  const ImuMeasurement& sample = next.sample;
  imu.force_spikes = next.force_spikes;
  imu.rate_spikes = next.rate_spikes;
  if (imu.in_gap) headings.is_current = false;  // no rate shows how the body turned meanwhile
  update_mean_force(*this, sample, next.step, dt_s);
  if (phase != Phase::waiting && imu.in_gap) {
    end_imu_gap(*this, sample.time_ns);
  } else if (phase != Phase::waiting && has_step) {
    const ImuStep& step = next.step;
    constexpr double smooth_mps2 = 2.5;
    constexpr double smooth_radps = 1.0;
    const Vector3d shock_mps = imu.shocks.add(sample.force_body_mps2, dt_s, smooth_mps2);
    const Vector3d shock_rad = imu.turn_shocks.add(sample.rate_body_radps, dt_s, smooth_radps);
    predict(*this, step);
    add_uncertain_motion(*this, shock_mps, shock_rad);
    if (step.attitude_std_rad > 0.0) {
      propagate();
      for (Hypothesis& each : bank) add_missed_motion(each.filter, step);
    }
    add_uncertain_motion(*this, dropped_share * next.dropped_impulse_body_mps,
                         dropped_share * next.dropped_turn_body_rad);
    if (imu.rate_spikes.held_s == 0.0)
      add_missed_turn(*this, imu.gyro_clip.add(sample.rate_body_radps), dt_s);
  }
  if (!is_first && !imu.in_gap) {
    imu.nominal_imu_period_s = kalman::nominal_imu_period_s(imu.nominal_imu_period_s, dt_s);
    turn_last_heading(*this, sample, next.step);
  }
  const TimeNs before_ns = imu.time_ns;
  imu.time_ns = time_ns = sample.time_ns;
  imu.rate_body_radps = sample.rate_body_radps;
  imu.force_body_mps2 = sample.force_body_mps2;
  ImuOutcome outcome;
  update_rest(*this, sample, outcome);
  bound_dead_reckoning(*this, outcome);
  update_zero_velocity(*this, outcome.zero_velocity_variance);
  hold_plane(*this, settings.planar, before_ns);
  const Hypothesis* const former = bank.find(Track::former);
  if (former != nullptr && seconds_between(former->explained_ns, time_ns) > max_former_age_s)
    bank.remove(former);
  return outcome;
}

void State::apply_pending_steps() {
  if (imu.pending_steps.empty()) return;
  const ImuStep step = imu.pending_steps.joined();
  for (Hypothesis& each : bank) {
    each.filter.predict(step.rate_body_radps, step.force_body_mps2, step.duration_s);
    if (!each.filter.ignores_force)
      each.filter.position_world_m += each.filter.q_body_to_world * step.made_up_shift_body_m;
  }
  Filter& best = bank.best().filter;
  frozen_track.move(step.duration_s, measured_acceleration_world_mps2(best, step));
  if (imu.pending_steps.joined_differs()) set_latest(best, best, imu.pending_steps.latest());  // for the pose
  imu.pending_steps = ImuPreintegrator{};
}

void State::propagate() {
  apply_pending_steps();
  for (Hypothesis& each : bank) each.filter.propagate(process_noise(imu, each.imu));
}

bool State::is_repetition(const ImuMeasurement& sample) const {
  constexpr double min_rate_radps = 0.05;
  constexpr double min_force_error_mps2 = 0.3;
  constexpr double min_speed_mps = 0.3;
  if (phase == Phase::waiting || !imu.repeats.repeats_with(imu.latest(), sample)) return false;
  if (imu.in_gap && imu.repeats.repeats > RepeatDetector::min_repeats) return true;  // so was the one before
  // A sensor of a body that stands may have no noise, and repeating it is right.
  const double force_error_mps2 = sample.force_body_mps2.norm() - gravity_world_mps2.norm();
  return (sample.rate_body_radps - filter().gyro_bias_body_radps).norm() > min_rate_radps ||
         std::abs(force_error_mps2) > min_force_error_mps2 ||
         filter().velocity_world_mps.norm() > min_speed_mps;
}

bool State::covariance_is_old() const {
  constexpr double max_duration_s = 0.2;
  return phase != Phase::waiting && filter().pending.duration_s > max_duration_s;
}

NominalState State::nominal() const {
  if (phase == Phase::waiting) return {};
  if (imu.pending_steps.empty()) return static_cast<const NominalState&>(filter());
  return nominal_after_steps(filter(), filter(), imu.pending_steps);
}

NominalState State::nominal_after(const ImuStep& step) const {
  const bool joins = can_join(*this, step.duration_s);
  ImuPreintegrator steps = joins ? imu.pending_steps : ImuPreintegrator{};
  steps.add(step);
  return nominal_after_steps(filter(), joins ? static_cast<const NominalState&>(filter()) : nominal(), steps);
}

void recover_if_not_finite(State& state) {
  if (state.phase == Phase::waiting || state.filter().is_finite()) return;
  state.bank.clear();
  state.headings = {.seen_ns = state.headings.seen_ns, .interval_s = state.headings.interval_s};
  state.imu.mean_force_body_mps2 = state.imu.force_body_mps2;
  state.frozen_track = {};
  state.imu_fault = {};
  state.twist = {};
  state.known = {};
  state.phase = Phase::waiting;
}

}  // namespace sonopose::estimation::kalman
