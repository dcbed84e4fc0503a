// Judgement of a velocity of the body.

#include "estimation/kalman/state_internal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sonopose::estimation::kalman {
namespace {

// Thresholds on the χ² of one axis, 1 degree of freedom:
constexpr double axis_chi2_huber_threshold = 6.6;  // 1 % is above
constexpr double axis_chi2_reject_threshold = 25.0;
constexpr double mean_chi2_reject_threshold = 16.0;
constexpr double error_memory_s = 0.2;  // time for which errors of wheels are alike

constexpr double scale_wander = 0.01;  // deviation of the scale from its slow mean, as of wheels in curves

/// A velocity under judgement.
struct JudgedTwist {
  const TwistMeasurement& measured;
  Vector3d from_tracked_body_m;
  double ahead_s;
  double likeness;  ///< number of consecutive velocities with the same error

  [[nodiscard]] bool has(int axis) const { return measured.std_mps[axis] >= 0.0; }
  [[nodiscard]] bool is_scaled(int axis) const { return (measured.constrained & (1 << axis)) == 0; }
  [[nodiscard]] double variance(int axis) const {
    const double wander_mps = is_scaled(axis) ? scale_wander * measured.velocity_body_mps[axis] : 0.0;
    return square(measured.std_mps[axis]) + square(wander_mps);
  }
  [[nodiscard]] VelocityInnovation innovation(const Filter& filter, int axis) const {
    return filter.velocity_innovation(axis, measured.velocity_body_mps[axis], variance(axis),
                                      from_tracked_body_m, is_scaled(axis), ahead_s);
  }
};

double squared_norm(const VelocityInnovation& innovation) {
  return square(innovation.value_mps) / innovation.variance_m2ps2;
}

void correct(Filter& filter, const JudgedTwist& twist, int axis, const VelocityInnovation& innovation) {
  const double scale = std::max(1.0, squared_norm(innovation) / axis_chi2_huber_threshold);
  filter.correct_velocity(innovation, (scale * twist.likeness - 1.0) * twist.variance(axis));
}

void note_interval(TwistGate& gate, TimeNs time_ns) {
  constexpr double smoothing_factor = 1.0 / 8.0;
  constexpr double max_interval_s = 1.0;
  if (gate.seen_ns != 0) {
    const double last_s = std::clamp(seconds_between(gate.seen_ns, time_ns), 0.0, max_interval_s);
    gate.interval_s += (gate.interval_s > 0.0 ? smoothing_factor : 1.0) * (last_s - gate.interval_s);
  }
  gate.seen_ns = time_ns;
}

/// True if wheels began to slip a short time ago, and velocities were rejected in the last half second.
bool is_slipping(const TwistGate& gate, TimeNs time_ns) {
  constexpr double ends_s = 0.5;
  constexpr double longest_s = 1.5;
  return gate.rejected_since_ns != 0 && seconds_between(gate.rejected_ns, time_ns) < ends_s &&
         seconds_between(gate.rejected_since_ns, time_ns) < longest_s;
}

/// True if this axis, or its mean over the last tenths of a second, contradicts the best filter. While wheels
/// slip, less contradicts: the filter grows uncertain.
bool contradicts(TwistGate& gate, const JudgedTwist& twist, int axis, const VelocityInnovation& innovation) {
  constexpr double memory_s = 0.15;
  const double share = std::min(1.0, std::max(gate.interval_s, 0.001) / memory_s);
  double& mean_mps = gate.mean_innovation_mps[axis];
  mean_mps += share * (innovation.value_mps - mean_mps);
  const double mean_variance =
      innovation.variance_m2ps2 - (1.0 - share / (2.0 - share)) * square(twist.measured.std_mps[axis]);
  const bool is_strict = twist.is_scaled(axis) && is_slipping(gate, twist.measured.time_ns);
  return squared_norm(innovation) > (is_strict ? axis_chi2_huber_threshold : axis_chi2_reject_threshold) ||
         square(mean_mps) / mean_variance >
             (is_strict ? axis_chi2_huber_threshold : mean_chi2_reject_threshold);
}

/// Believes in another scale that has contradicted used fixes for long. Wheels rarely slip so long.
void doubt_scale(State& state, const JudgedTwist& twist, const VelocityInnovation& innovation) {
  constexpr double believed_after_s = 4.0;
  constexpr double min_speed_mps = 0.2;
  TwistGate& gate = *state.twist;
  const TimeNs now_ns = twist.measured.time_ns;
  const double error = innovation.value_mps / innovation.estimated_mps;
  if (!state.filter().scale || seconds_between(gate.rejected_since_ns, now_ns) < believed_after_s ||
      seconds_between(state.fixes.used_ns, now_ns) > 1.0 || !(std::abs(error) < max_scale_error) ||
      std::abs(innovation.estimated_mps) < min_speed_mps)
    return;
  gate.rejected_since_ns = now_ns;
  for (Hypothesis& each : state.bank) {
    if (each.filter.scale && each.imu != ImuModel::wrong_velocities)
      each.filter.scale->variance += square(error);
  }
}

/// Registers a contradiction. It belongs to the current run if the last one was within a second.
void note_contradiction(TwistGate& gate, TimeNs time_ns) {
  constexpr double run_ends_s = 1.0;
  if (gate.rejected_since_ns == 0 || seconds_between(gate.rejected_ns, time_ns) > run_ends_s) {
    gate.rejected_since_ns = time_ns;
  }
  gate.rejected_ns = time_ns;
  gate.rejected = true;
}

/// False for the model that follows the fixes alone, which has no direction, and for the one that uses none.
bool uses_velocities(ImuModel model) {
  return model != ImuModel::distrusts_imu && model != ImuModel::wrong_velocities;
}

/// Compares a velocity along an axis with that of the filter that uses none, if the body moves fast enough.
void compare(TwistGate& gate, const VelocityInnovation& independent) {
  constexpr double max_agreed_s = 20.0;
  constexpr double max_relative_std = 0.1;
  const double speed_mps = std::abs(independent.estimated_mps);
  if (independent.variance_m2ps2 > square(max_relative_std * speed_mps)) return;
  const bool agrees = std::abs(independent.value_mps) <= max_scale_error * speed_mps;
  gate.agreed_s = std::clamp(gate.agreed_s + (agrees ? 1.0 : -1.0) * gate.interval_s, 0.0, max_agreed_s);
}

/// Corrects the filters of the followed track, axis by axis.
void judge(State& state, const JudgedTwist& twist) {
  TwistGate& gate = *state.twist;
  if (state.bank.find(ImuModel::wrong_velocities) == nullptr && !is_distrustful(state.bank.best().imu)) {
    Hypothesis& without = state.bank.spawn(state.bank.best());
    set_imu_model(without, ImuModel::wrong_velocities);
    inflate(without.filter,
            {.velocity_mps = 0.5, .yaw_rad = radians(20.0)});  // velocities shaped them until now
  }
  const Hypothesis* const independent = state.bank.find(ImuModel::wrong_velocities);
  const ImuModel best = state.bank.best().imu;
  const bool shape_best = uses_velocities(best) && !is_distrustful(best);
  bool is_used = false;
  gate.rejected = false;
  for (int axis = 0; axis < 3; ++axis) {
    if (!twist.has(axis)) continue;
    const VelocityInnovation of_best = twist.innovation(state.filter(), axis);
    if (independent != nullptr && twist.is_scaled(axis))
      compare(gate, twist.innovation(independent->filter, axis));
    const bool rejected = contradicts(gate, twist, axis, of_best);
    if (rejected && twist.is_scaled(axis)) {
      note_contradiction(gate, twist.measured.time_ns);
      doubt_scale(state, twist, of_best);
    }
    is_used = is_used || (shape_best && !rejected && twist.is_scaled(axis));
    for (Hypothesis& each : state.bank) {
      if (each.track != Track::followed || !uses_velocities(each.imu) ||
          (rejected && !is_distrustful(each.imu)))
        continue;
      const bool is_best = &each == &state.bank.best();
      const VelocityInnovation own = is_best ? of_best : twist.innovation(each.filter, axis);
      if (squared_norm(own) <= axis_chi2_reject_threshold) correct(each.filter, twist, axis, own);
    }
  }
  // A measured velocity bounds dead reckoning better than the assumption that the body does not move.
  if (is_used) state.last_zero_velocity_ns = std::max(state.last_zero_velocity_ns, twist.measured.time_ns);
}

/// Scores and corrects the starts, among each other: the one that follows the fixes alone has no direction.
void score_starts(State& state, const JudgedTwist& twist) {
  std::array<double, HypothesisBank::capacity> likelihoods{};
  double best = -std::numeric_limits<double>::infinity();
  const auto is_start = [](const Hypothesis& each) {
    return each.track == Track::followed && each.imu != ImuModel::distrusts_imu;
  };
  for (Hypothesis& each : state.bank) {
    if (!is_start(each)) continue;
    double& likelihood = likelihoods.at(static_cast<std::size_t>(state.bank.index_of(each)));
    for (int axis = 0; axis < 3; ++axis) {
      if (!twist.has(axis)) continue;
      const VelocityInnovation own = twist.innovation(each.filter, axis);
      likelihood += -3.5 * std::log1p(squared_norm(own) / 6.0) - 0.5 * std::log(own.variance_m2ps2);
      correct(each.filter, twist, axis, own);
    }
    best = std::max(best, likelihood);
  }
  state.twist->rejected = false;
  for (Hypothesis& each : state.bank) {
    if (!is_start(each)) continue;
    each.score +=
        (likelihoods.at(static_cast<std::size_t>(state.bank.index_of(each))) - best) / twist.likeness;
  }
  prune_starts(state);
}

}  // namespace

void State::on_twist(const settings::Settings& settings, const TwistMeasurement& measured) {
  if (phase == Phase::waiting || restart_pending) return;
  propagate();
  predict_if_silent(*this, settings, measured.time_ns);
  if (!twist) twist.push({});
  note_interval(*twist, measured.time_ns);
  for (Hypothesis& each : bank) {
    if (settings.twist.scale_std > 0.0 && !each.filter.scale)
      each.filter.scale.push({.variance = square(settings.twist.scale_std)});
  }
  const JudgedTwist judged{
      .measured = measured,
      .from_tracked_body_m = Vector3d(settings.twist.point_x_m, settings.twist.point_y_m, 0.0),
      .ahead_s = seconds_between(time_ns, measured.time_ns),
      .likeness = twist->interval_s > 0.0 ? std::clamp(error_memory_s / twist->interval_s, 1.0, 50.0) : 1.0};
  if (phase == Phase::searching_yaw) {
    score_starts(*this, judged);
  } else {
    judge(*this, judged);
  }
  recover_if_not_finite(*this);
}

}  // namespace sonopose::estimation::kalman
