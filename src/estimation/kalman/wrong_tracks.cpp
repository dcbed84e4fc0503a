// Fixes that the best filter rejects: the rival track that they form, and the former track.

#include "estimation/kalman/belief_parts.hpp"

#include <algorithm>

namespace sonopose::estimation::kalman {
namespace {

constexpr TimeNs converging_ns = 500'000'000;  // after a jump

}  // namespace

/// Of a fix that the best filter accepts. Soon after a start it accepts much, also what a wrong first fix
/// contradicts.
bool Belief::rival_explains_better(const FixMeasurement& fix, const Matrix3d& covariance, double ahead_s,
                                   const Innovation& innovation) const {
  constexpr double advantage = 2.0;
  if (fixes_since_start >= proven_fixes || !rival.alive) return false;
  const Innovation of_rival = rival.filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
  return of_rival.squared_norm <= rejected_above &&
         log_likelihood(of_rival) > log_likelihood(innovation) + advantage;
}

/// Whether the fixes contradict the start, or have found no track from what the best filter became.
bool Belief::must_start_again(TimeNs now_ns) const {
  constexpr int agreeing = 3;
  constexpr int many = 12;
  constexpr double lost_s = 8.0;
  if (rival.fixes < agreeing) return false;
  if (fixes_since_start < proven_fixes && rival.fixes > fixes_since_start) return true;
  return fixes_rejected_in_row >= many && seconds_between(last_fix_ns, now_ns) > lost_s;
}

void Belief::reject(const settings::Settings& settings, const FixMeasurement& fix, const Matrix3d& covariance,
                    double ahead_s, FixOutcome& outcome) {
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
  rival.filter.correct_fix(innovation, (scale_of(innovation) - 1.0) * covariance);
  rival.last_fix_ns = fix.time_ns;
  ++rival.fixes;
  if (must_start_again(fix.time_ns)) {
    start_at(fix, settings);
    outcome.flags = fix_used | fix_stuck_forced;
    outcome.weight = 1.0;
    return;
  }
  const double jump_m =
      (rival.filter.tracked_position_world_m() - filter().tracked_position_world_m()).norm();
  const double needed_s =
      map_has_turned(fix.time_ns) ? 1.0 : std::clamp(2.2 - (jump_m - 1.5) / 0.5 * 1.2, 1.0, 2.2);
  const double alone_s = seconds_between(std::max(last_fix_ns, rival.began_ns), fix.time_ns);
  const bool enough_fixes = rival.fixes >= 8 || (rival.fixes >= 3 && alone_s > 3.0);
  const bool explains_most = rival.fixes >= 16 && rival.fixes > 2 * rival.fixes_of_best &&
                             seconds_between(rival.began_ns, fix.time_ns) > 4.0;
  if ((alone_s < needed_s || !enough_fixes) && !explains_most) return;
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
  rival.fixes_of_best = 0;
  const bool open = seconds_between(last_fix_ns, fix.time_ns) > lost_s || map_has_turned(fix.time_ns);
  rival.filter = filter();
  Filter& f = rival.filter;
  f.position_world_m = fix.position_world_m + f.q_body_to_world * f.lever_arm_body_m;
  f.decorrelate(at_position, 2.0 * covariance.diagonal());
  if (!open) return;
  f.decorrelate(at_velocity, Vector3d::Constant(square(2.0)));
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
  former.filter.correct_fix(innovation);
  if (++former.fixes_in_row < enough) return false;
  adopt(former.filter);
  former.alive = false;
  rival.alive = false;
  last_fix_ns = fix.time_ns;
  converging_until_ns = time_ns + converging_ns;
  rest::restart(rest);
  return true;
}

}  // namespace sonopose::estimation::kalman
