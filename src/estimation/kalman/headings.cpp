// Headings of the pair.

#include "estimation/kalman/belief_parts.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

constexpr double full_below = 6.6;  // χ², 1 degree of freedom: 1 % is above
constexpr double heading_rejected_above = 25.0;

/// By how much the variance of a heading grows with its innovation.
double scale_of(const Filter::HeadingInnovation& innovation) {
  return std::max(1.0, squared_norm(innovation) / full_below);
}

}  // namespace

HeadingOutcome Belief::on_heading(const settings::Settings& settings, const HeadingMeasurement& heading) {
  see_heading(heading);
  if (phase == Phase::waiting || repetition.frozen || restart_pending) {
    keep_heading(settings, heading);
    return {};
  }
  propagate();
  coast_if_silent(settings, heading.time_ns);
  HeadingOutcome outcome;
  if (phase == Phase::searching_yaw) {
    keep_heading(settings, heading);
    outcome = score_starts(settings, heading);
  } else {
    outcome = judge_heading(settings, heading);
  }
  recover_if_not_finite();
  return outcome;
}

/// Keeps a heading for a start, turned to the time of the latest sample.
void Belief::keep_heading(const settings::Settings& settings, const HeadingMeasurement& heading) {
  const double since_sample_s = seconds_between(time_ns, heading.time_ns);
  const bool in_motion = time_ns != 0 && since_sample_s < settings.outage.imu_gap_s;
  last_heading_ns = heading.time_ns;
  last_heading_rad = heading.heading_world_rad - (in_motion ? since_sample_s * up_rate_radps() : 0.0);
  heading_is_current = true;
}

/// Scores and corrects each start by a heading, and removes those that it contradicts.
HeadingOutcome Belief::score_starts(const settings::Settings& settings, const HeadingMeasurement& heading) {
  const double mount_rad = radians(settings.heading.mount_offset_deg);
  const double ahead_s = seconds_between(state_ns, heading.time_ns);
  const double variance = noise.heading_rad2.variance;
  HeadingOutcome outcome{.variance_rad2 = variance};
  for (int i = 0; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    const auto innovation =
        candidate.filter.heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
    if (!innovation.observable) continue;
    const double own_variance = scale_of(innovation) * variance;
    if (i == best) outcome = {.used = true, .variance_rad2 = own_variance};
    candidate.score += log_likelihood(innovation);
    candidate.filter.correct_heading(heading.heading_world_rad, mount_rad, own_variance, ahead_s);
  }
  prune_starts();
  return outcome;
}

/// Uses or rejects a heading while tracking.
HeadingOutcome Belief::judge_heading(const settings::Settings& settings, const HeadingMeasurement& heading) {
  const double mount_rad = radians(settings.heading.mount_offset_deg);
  const double ahead_s = seconds_between(state_ns, heading.time_ns);
  const double variance = noise.heading_rad2.variance;
  HeadingOutcome outcome{.variance_rad2 = variance};
  const auto innovation_of = [&](const Filter& each) {
    return each.heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
  };
  const auto innovation = innovation_of(filter());
  if (!innovation.observable) return outcome;
  const bool rejected = squared_norm(innovation) > heading_rejected_above;
  suspect_imu(squared_norm(innovation) > explained_below);
  if (best != open_gyro && has_open_models()) {
    Filter& open = candidates[open_gyro].filter;
    const auto of_gyro = innovation_of(open);
    explanations.add_heading(innovation, of_gyro);
    if (rejected && squared_norm(of_gyro) <= heading_rejected_above) {
      open.correct_heading(heading.heading_world_rad, mount_rad, scale_of(of_gyro) * variance, ahead_s);
    }
    if (const int model = wrong_sensor(); rejected && model != best) {
      doubt_imu(model);
      outcome.used = true;
      keep_heading(settings, heading);
      return outcome;
    }
  }
  if (rejected && !reject_heading(heading.time_ns, innovation.value_rad)) {
    turn_rival(heading, mount_rad, innovation.value_rad);
    return outcome;
  }
  outcome.used = true;
  if (rejected) {
    outcome.added_variance_rad2 = square(innovation.value_rad);
  } else {
    outcome.variance_rad2 *= scale_of(innovation);
  }
  heading_rejected_since_ns = 0;
  headings_rejected_in_row = 0;
  keep_heading(settings, heading);
  for (int i = 0; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    if (squared_norm(innovation_of(candidate.filter)) > heading_rejected_above)
      candidate.explained_in_row = 0;
  }
  for_each_filter([&](Filter& each, const ProcessNoise&) {
    if (rejected) each.add_yaw_variance(outcome.added_variance_rad2);
    each.correct_heading(heading.heading_world_rad, mount_rad, scale_of(innovation_of(each)) * variance,
                         ahead_s);
  });
  const auto after = innovation_of(filter());
  noise.add_heading(after.value_rad, after.variance_rad2 - variance, stands_still(few_fixes));
  return outcome;
}

void Belief::widen_yaw(double std_rad) {
  for_each_filter([&](Filter& each, const ProcessNoise&) { each.add_yaw_variance(square(std_rad)); });
}

void Belief::on_mount_offset_change(double by_rad) {
  if (phase == Phase::waiting || seconds_between(last_heading_ns, time_ns) > heading_run_ends_s()) return;
  widen_yaw(by_rad);
  heading_rejected_since_ns = 0;
  headings_rejected_in_row = 0;
}

void Belief::see_heading(const HeadingMeasurement& heading) {
  constexpr double share = 1.0 / 8.0;
  if (heading_seen_ns != 0) {
    const double interval_s =
        std::clamp(seconds_between(heading_seen_ns, heading.time_ns), 0.0, longest_heading_interval_s);
    heading_interval_s += (heading_interval_s > 0.0 ? share : 1.0) * (interval_s - heading_interval_s);
  }
  heading_seen_ns = heading.time_ns;
  rest::add_heading(rest, heading.time_ns, heading.heading_world_rad);
}

/// Time without a rejected heading after which a run of them has ended.
double Belief::heading_run_ends_s() const {
  return std::max(1.0, 3.0 * heading_interval_s);
}

/// Registers a rejected heading. True if headings have been rejected for so long that they must be believed.
bool Belief::reject_heading(TimeNs now_ns, double innovation_rad) {
  constexpr double believed_after_s = 4.0;
  constexpr int enough = 3;
  if (heading_rejected_since_ns == 0 || seconds_between(heading_rejected_ns, now_ns) > heading_run_ends_s()) {
    heading_rejected_since_ns = now_ns;
    headings_rejected_in_row = 0;
  }
  heading_rejected_ns = now_ns;
  heading_rejected_by_rad = innovation_rad;
  ++headings_rejected_in_row;
  return headings_rejected_in_row >= enough &&
         seconds_between(heading_rejected_since_ns, now_ns) >= believed_after_s;
}

/// Whether headings are rejected as well as fixes: a wrong track turns no heading, a turned map does.
bool Belief::map_has_turned(TimeNs now_ns) const {
  constexpr int enough = 2;
  return headings_rejected_in_row >= enough &&
         seconds_between(heading_rejected_ns, now_ns) < heading_run_ends_s();
}

/// Uses a heading that the best filter rejected for the rival. When the second one in a row shows that the
/// map has turned at once, the rival begins again with its motion turned.
void Belief::turn_rival(const HeadingMeasurement& heading, double mount_rad, double innovation_rad) {
  constexpr double same_turn_s = 0.5;
  constexpr double oldest_fix_s = 0.2;  // over which the velocity moves it
  if (!rival.alive) return;
  const double variance = noise.heading_rad2.variance;
  const double ahead_s = seconds_between(state_ns, heading.time_ns);
  if (rival.has_turned) {
    const auto innovation =
        rival.filter.heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
    if (!innovation.observable) return;
    if (squared_norm(innovation) > heading_rejected_above) {
      rival.has_turned = false;
      return;
    }
    ++rival.headings;
    rival.filter.correct_heading(heading.heading_world_rad, mount_rad, variance, ahead_s);
    return;
  }
  const bool at_once = headings_rejected_in_row == 2 &&
                       seconds_between(heading_rejected_since_ns, rival.began_ns) < same_turn_s &&
                       seconds_between(last_heading_ns, heading_rejected_since_ns) < heading_run_ends_s();
  const double fix_age_s = seconds_between(rival.rejected_ns, heading.time_ns);
  if (!at_once || fixes_rejected_in_row == 0 || fix_age_s > oldest_fix_s) return;
  rival.has_turned = true;
  rival.headings = 0;
  rival.fixes = 1;
  rival.misses_in_row = 0;
  rival.fixes_of_best = 0;
  rival.began_ns = rival.last_fix_ns = heading_rejected_since_ns;
  rival.filter = filter();
  rival.filter.turn_world(innovation_rad);
  Filter& f = rival.filter;
  f.position_world_m = rival.rejected_world_m + f.q_body_to_world * f.lever_arm_body_m +
                       seconds_between(rival.rejected_ns, state_ns) * f.velocity_world_mps;
  f.decorrelate(at_position, 2.0 * noise.fix_covariance_m2(quality_percent).diagonal());
  f.add_yaw_variance(variance);
}

}  // namespace sonopose::estimation::kalman
