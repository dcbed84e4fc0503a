// Judgement of a heading of the pair.

#include "estimation/kalman/state_internal.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

constexpr double heading_chi2_huber_threshold = 6.6;  // χ², 1 degree of freedom: 1 % is above

constexpr double wrong_heading_likelihood = -4.8;  // logarithm; a heading that is anywhere

/// Factor by which the variance of a heading grows with its innovation.
double scale_of(const Filter::HeadingInnovation& innovation) {
  return std::max(1.0, squared_norm(innovation) / heading_chi2_huber_threshold);
}

/// Student's t with six degrees of freedom, up to a constant.
double log_likelihood(const Filter::HeadingInnovation& innovation) {
  return -3.5 * std::log1p(squared_norm(innovation) / 6.0) - 0.5 * std::log(innovation.variance_rad2);
}

/// Evidence of a heading. One that is far off speaks against the gyroscope, since what disturbs a heading
/// turns it by a limited angle.
double evidence_of(const Filter::HeadingInnovation& innovation) {
  constexpr double turned_std_rad = radians(20.0);
  const double turned = 3.0 - 0.5 * square(innovation.value_rad / turned_std_rad);
  return std::max({log_likelihood(innovation), turned, wrong_heading_likelihood});
}

/// Evidence of a heading for the hypothesis that headings are wrong: they then keep a constant offset.
double evidence_of_offset(State& state, const Filter::HeadingInnovation& innovation) {
  const double max_rad = std::sqrt(heading_chi2_reject_threshold * innovation.variance_rad2);
  const auto deviation = state.headings.add_offset(innovation.value_rad, max_rad);
  if (!deviation) return wrong_heading_likelihood;
  return log_likelihood({.value_rad = *deviation, .variance_rad2 = innovation.variance_rad2});
}

/// True if the motion proves headings wrong. Fixes that are rejected with them may show a turned map.
bool overrules_headings(const State& state, const Hypothesis& without_headings) {
  return state.fixes.rejected_in_row == 0 && !is_distrustful(state.bank.best().imu) &&
         contradicts_headings(state, without_headings.filter);
}

bool is_same_yaw(const Filter& filter, const Filter& other) {
  constexpr double max_apart_rad = radians(5.0);
  return std::abs(geometry::wrap_angle(geometry::yaw_of(filter.q_body_to_world) -
                                       geometry::yaw_of(other.q_body_to_world))) < max_apart_rad;
}

/// Keeps a heading for a start, turned to the time of the latest sample.
void keep_heading(State& state, const settings::Settings& settings, const HeadingMeasurement& heading) {
  const double since_sample_s = seconds_between(state.imu.time_ns, heading.time_ns);
  const bool in_motion = state.imu.time_ns != 0 && since_sample_s < settings.outage.imu_gap_s;
  state.headings.used_ns = heading.time_ns;
  state.headings.heading_world_rad =
      heading.heading_world_rad - (in_motion ? since_sample_s * yaw_rate_radps(state) : 0.0);
  state.headings.std_rad = std::max(heading.std_rad, 0.0);
  state.headings.is_current = true;
}

/// Scores and corrects each start by a heading, and removes those that it contradicts.
HeadingOutcome score_starts(State& state, const settings::Settings& settings,
                            const HeadingMeasurement& heading) {
  const double variance = variance_of(state, heading);
  HeadingOutcome outcome{.variance_rad2 = variance};
  for (Hypothesis& each : state.bank) {
    const auto innovation = heading_innovation(state, each.filter, settings, heading);
    if (each.track != Track::followed || !innovation.observable) continue;
    const double own_variance = scale_of(innovation) * variance;
    if (state.bank.index_of(each) == state.bank.best_index) {
      outcome = {.used = true, .variance_rad2 = own_variance};
    }
    each.score += log_likelihood(innovation);
    correct_by_heading(state, each.filter, settings, heading, own_variance);
  }
  prune_starts(state);
  return outcome;
}

/// Uses or rejects a heading while tracking.
HeadingOutcome judge(State& state, const settings::Settings& settings, const HeadingMeasurement& heading) {
  const double variance = variance_of(state, heading);
  HeadingOutcome outcome{.variance_rad2 = variance};
  const auto innovation = heading_innovation(state, state.filter(), settings, heading);
  if (!innovation.observable) return outcome;
  const bool rejected = squared_norm(innovation) > heading_chi2_reject_threshold;
  Hypothesis* without_headings = state.bank.find(ImuModel::wrong_headings);
  if (rejected && without_headings != nullptr && overrules_headings(state, *without_headings)) {
    const auto own = heading_innovation(state, without_headings->filter, settings, heading);
    if (own.observable) evidence_of_offset(state, own);
    if (is_same_yaw(state.filter(), without_headings->filter)) {
      state.headings.accept();
    } else {
      state.headings.reject(heading.time_ns);
    }
    return outcome;
  }
  update_distrustful_models(state, squared_norm(innovation) > chi2_explain_threshold);
  state.imu_fault.shifted.evidence += evidence_of(innovation);
  if (without_headings == nullptr && !is_distrustful(state.bank.best().imu)) {
    without_headings = &state.bank.spawn(state.bank.best());
    set_imu_model(*without_headings, ImuModel::wrong_headings);
    inflate(without_headings->filter, {.yaw_rad = radians(20.0)});  // headings gave the yaw until now
    state.headings.offset_samples = 0;
  }
  for (Hypothesis& each : state.bank) {
    const auto own = heading_innovation(state, each.filter, settings, heading);
    if (&each == without_headings) {
      if (own.observable) each.evidence += evidence_of_offset(state, own);
      continue;
    }
    if (own.observable) each.evidence += evidence_of(own);
    const bool explains = squared_norm(own) <= heading_chi2_reject_threshold;
    if (!explains && each.track == Track::followed) each.explained_in_row = 0;
    // A wrong yaw or gyroscope is corrected by the headings that it makes the others reject.
    const bool doubts_yaw = each.imu == ImuModel::distrusts_gyro || each.imu == ImuModel::jumped;
    if (rejected && explains && doubts_yaw && each.track == Track::followed)
      correct_by_heading(state, each.filter, settings, heading, scale_of(own) * variance);
  }
  if (rejected && switch_to_distrustful_model(state)) {
    outcome.used = true;
    keep_heading(state, settings, heading);
    return outcome;
  }
  const bool may_be_believed = without_headings == nullptr || !motion_shows_yaw(without_headings->filter);
  if (rejected && !(state.headings.reject(heading.time_ns) && may_be_believed)) {
    judge_turned_map(state, settings, heading, innovation.value_rad);
    return outcome;
  }
  outcome.used = true;
  if (rejected) {
    outcome.added_variance_rad2 = square(innovation.value_rad);
  } else {
    outcome.variance_rad2 *= scale_of(innovation);
  }
  state.headings.accept();
  keep_heading(state, settings, heading);
  for (Hypothesis& each : state.bank) {
    if (&each == without_headings) continue;
    if (rejected) each.filter.add_yaw_variance(outcome.added_variance_rad2);
    const auto own = heading_innovation(state, each.filter, settings, heading);
    correct_by_heading(state, each.filter, settings, heading, scale_of(own) * variance);
  }
  // Errors of headings that the motion overrules are no noise.
  if (heading.std_rad >= 0.0 || state.bank.best().imu == ImuModel::wrong_headings) return outcome;
  const auto after = heading_innovation(state, state.filter(), settings, heading);
  state.noise.add_heading(after.value_rad, after.variance_rad2 - variance,
                          stands_still(state, min_rest_fixes));
  return outcome;
}

}  // namespace

double variance_of(const State& state, const HeadingMeasurement& heading) {
  return heading.std_rad >= 0.0 ? square(heading.std_rad) : state.noise.heading_rad2.variance;
}

Filter::HeadingInnovation heading_innovation(const State& state, const Filter& filter,
                                             const settings::Settings& settings,
                                             const HeadingMeasurement& heading) {
  return filter.heading_innovation(heading.heading_world_rad, radians(settings.heading.mount_offset_deg),
                                   variance_of(state, heading),
                                   seconds_between(state.time_ns, heading.time_ns));
}

void correct_by_heading(const State& state, Filter& filter, const settings::Settings& settings,
                        const HeadingMeasurement& heading, double variance_rad2) {
  filter.correct_heading(heading.heading_world_rad, radians(settings.heading.mount_offset_deg), variance_rad2,
                         seconds_between(state.time_ns, heading.time_ns));
}

HeadingOutcome State::on_heading(const settings::Settings& settings, const HeadingMeasurement& heading) {
  headings.add(heading.time_ns);
  rest::add_heading(rest, heading.time_ns, heading.heading_world_rad);
  if (heading.restarts && phase != Phase::waiting) restart_pending = true;
  if (phase == Phase::waiting || frozen_track.frozen || restart_pending) {
    keep_heading(*this, settings, heading);
    return {};
  }
  propagate();
  predict_if_silent(*this, settings, heading.time_ns);
  HeadingOutcome outcome;
  if (phase == Phase::searching_yaw) {
    keep_heading(*this, settings, heading);
    outcome = score_starts(*this, settings, heading);
  } else {
    outcome = judge(*this, settings, heading);
  }
  recover_if_not_finite(*this);
  return outcome;
}

void State::on_mount_offset_change(double by_rad) {
  if (phase == Phase::waiting ||
      seconds_between(headings.used_ns, imu.time_ns) > headings.rejection_timeout_s())
    return;
  for (Hypothesis& each : bank) each.filter.add_yaw_variance(square(by_rad));
  headings.accept();
}

void HeadingGate::add(TimeNs time_ns) {
  constexpr double smoothing_factor = 1.0 / 8.0;
  if (seen_ns != 0) {
    const double last_s = std::clamp(seconds_between(seen_ns, time_ns), 0.0, max_heading_interval_s);
    interval_s += (interval_s > 0.0 ? smoothing_factor : 1.0) * (last_s - interval_s);
  }
  seen_ns = time_ns;
}

std::optional<double> HeadingGate::add_offset(double difference_rad, double max_rad) {
  constexpr int max_mean_samples = 8;
  const double deviation_rad = geometry::wrap_angle(difference_rad - offset_rad);
  if (offset_samples == 0 || std::abs(deviation_rad) > max_rad) {
    offset_rad = difference_rad;
    offset_samples = 1;
    return std::nullopt;
  }
  offset_samples = std::min(offset_samples + 1, proven_offset_samples);
  offset_rad = geometry::wrap_angle(offset_rad + deviation_rad / std::min(offset_samples, max_mean_samples));
  return deviation_rad;
}

bool HeadingGate::reject(TimeNs time_ns) {
  constexpr double believed_after_s = 4.0;
  constexpr int min_rejected_headings = 3;
  if (rejected_since_ns == 0 || seconds_between(rejected_ns, time_ns) > rejection_timeout_s()) {
    rejected_since_ns = time_ns;
    rejected_in_row = 0;
  }
  rejected_ns = time_ns;
  ++rejected_in_row;
  return rejected_in_row >= min_rejected_headings &&
         seconds_between(rejected_since_ns, time_ns) >= believed_after_s;
}

void HeadingGate::accept() {
  rejected_since_ns = 0;
  rejected_in_row = 0;
}

double HeadingGate::rejection_timeout_s() const {
  return std::max(1.0, 3.0 * interval_s);
}

}  // namespace sonopose::estimation::kalman
