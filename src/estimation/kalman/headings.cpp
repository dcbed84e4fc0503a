// Headings of the pair.

#include "estimation/kalman/belief_parts.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

constexpr double full_below = 6.6;  // χ², 1 degree of freedom: 1 % is above
constexpr double heading_rejected_above = 25.0;

}  // namespace

HeadingOutcome Belief::on_heading(const settings::Settings& settings, const HeadingMeasurement& heading) {
  if (phase == Phase::waiting || repetition.frozen || restart_pending) {
    last_heading_ns = heading.time_ns;
    last_heading_rad = heading.heading_world_rad;
    return {};
  }
  propagate();
  coast_if_silent(settings, heading.time_ns);
  const double mount_rad = radians(settings.heading.mount_offset_deg);
  const double ahead_s = seconds_between(state_ns, heading.time_ns);
  const double variance = noise.heading_rad2.variance;
  HeadingOutcome outcome{.variance_rad2 = variance};
  if (phase == Phase::searching_yaw) {
    last_heading_ns = heading.time_ns;
    last_heading_rad = heading.heading_world_rad;
    for (int i = 0; i < candidate_count; ++i) {
      Candidate& candidate = candidates[static_cast<std::size_t>(i)];
      const auto innovation =
          candidate.filter.heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
      if (!innovation.observable) continue;
      const double d = square(innovation.value_rad) / innovation.variance_rad2;
      if (i == best) outcome = {.used = true, .variance_rad2 = std::max(1.0, d / full_below) * variance};
      candidate.score += -3.5 * std::log1p(d / 6.0) - 0.5 * std::log(innovation.variance_rad2);
      candidate.filter.correct_heading(heading.heading_world_rad, mount_rad,
                                       std::max(1.0, d / full_below) * variance, ahead_s);
    }
    prune_starts();
    recover_if_not_finite();
    return outcome;
  }
  const auto innovation =
      filter().heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
  if (!innovation.observable) return outcome;
  const double d = square(innovation.value_rad) / innovation.variance_rad2;
  const bool rejected = d > heading_rejected_above;
  if (rejected && !reject_heading(heading.time_ns)) return outcome;
  outcome.used = true;
  if (rejected) {
    outcome.added_variance_rad2 = square(innovation.value_rad);
  } else {
    outcome.variance_rad2 *= std::max(1.0, d / full_below);
  }
  heading_rejected_since_ns = 0;
  headings_rejected_in_row = 0;
  last_heading_ns = heading.time_ns;
  last_heading_rad = heading.heading_world_rad;
  for_each_filter([&](Filter& each, const ProcessNoise&) {
    if (rejected) each.add_yaw_variance(outcome.added_variance_rad2);
    const auto own = each.heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
    const double own_d = square(own.value_rad) / own.variance_rad2;
    each.correct_heading(heading.heading_world_rad, mount_rad, std::max(1.0, own_d / full_below) * variance,
                         ahead_s);
  });
  const auto after = filter().heading_innovation(heading.heading_world_rad, mount_rad, variance, ahead_s);
  noise.add_heading(after.value_rad, after.variance_rad2 - variance);
  recover_if_not_finite();
  return outcome;
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
