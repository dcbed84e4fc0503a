// Fixes that the best filter rejects: the rival track that they form, and the former track.

#include "estimation/kalman/belief_parts.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

constexpr TimeNs converging_ns = 500'000'000;  // after a jump
constexpr double established_s = 4.0;          // a track that was followed for less may be wrong
constexpr int many = 12;                       // rejected fixes in a row

}  // namespace

/// Whether the best filter follows a track that was found a moment ago and may be wrong.
bool Belief::has_just_jumped(TimeNs now_ns) const {
  return converging_until_ns != 0 && seconds_between(converging_until_ns, now_ns) < established_s;
}

/// Registers that the best filter was moved to this fix at once.
void Belief::note_jump(TimeNs fix_ns) {
  converging_until_ns = std::max(time_ns, fix_ns) + converging_ns;
  last_fix_ns = fix_ns;
  fixes_rejected_in_row = 0;
}

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

/// Time since the last fix that the best filter used; 0 if it rejected fewer fixes since then: a silence
/// alone says nothing.
double Belief::unexplained_s(int least_rejected, TimeNs now_ns) const {
  return fixes_rejected_in_row < least_rejected ? 0.0 : seconds_between(last_fix_ns, now_ns);
}

/// Whether no start explains the fixes. The rival is a copy of a start, so it may not find their track
/// either. A body without acceleration does not contradict a start: rejected fixes are then wrong themselves.
bool Belief::all_starts_are_wrong(TimeNs now_ns) const {
  constexpr double lost_s = 1.5;
  return phase == Phase::searching_yaw && rest.still_windows == 0 && unexplained_s(many, now_ns) > lost_s;
}

/// Whether the fixes contradict the start, or have found no track from what the best filter became.
bool Belief::must_start_again(TimeNs now_ns) const {
  constexpr int agreeing = 3;
  constexpr double lost_s = 8.0;
  if (rival.fixes < agreeing) return false;
  if (fixes_since_start < proven_fixes && rival.fixes > fixes_since_start) return true;
  return unexplained_s(many, now_ns) > lost_s;
}

void Belief::reject(const settings::Settings& settings, const FixMeasurement& fix, const Matrix3d& covariance,
                    double ahead_s, FixOutcome& outcome) {
  outcome.flags = fix_outlier;
  rival.rejected_world_m = fix.position_world_m;
  rival.rejected_ns = fix.time_ns;
  if (take_back_former(fix, covariance, ahead_s)) {
    outcome.flags = fix_used;
    outcome.weight = 1.0;
    return;
  }
  bool starts_again = all_starts_are_wrong(fix.time_ns);
  if (!starts_again) {
    if (!rival_explains(fix, covariance, ahead_s, outcome)) return;
    starts_again = must_start_again(fix.time_ns);
    if (!starts_again && !rival_has_won(fix.time_ns)) return;
  }
  // While yaw is searched, the rival copies one of the starts, whose yaw is arbitrary.
  if (starts_again || phase == Phase::searching_yaw) {
    start_at(fix, settings);
  } else {
    promote_rival();
  }
  note_jump(fix.time_ns);
  outcome.flags = fix_used | fix_stuck_forced;
  outcome.weight = 1.0;
}

/// Corrects the rival by a fix that it explains. Another one begins it, or counts as a miss.
bool Belief::rival_explains(const FixMeasurement& fix, const Matrix3d& covariance, double ahead_s,
                            FixOutcome& outcome) {
  if (!rival.alive) {
    begin_rival(fix, covariance);
    return false;
  }
  const Innovation innovation = rival.filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
  if (!(innovation.squared_norm <= rejected_above)) {
    learn_from_scatter(fix, outcome.innovation);
    // A track that many fixes support survives a short spike. Soon after a jump a rival of one fix begins
    // again at its first miss: it began with the motion of a track that may be wrong.
    const int least_misses = has_just_jumped(fix.time_ns) ? 1 : 3;
    const int most_misses = least_misses + std::min(rival.fixes / 2, 9);
    if (++rival.misses_in_row >= most_misses) begin_rival(fix, covariance);
    return false;
  }
  outcome.hypothesis = 1;
  rival.misses_in_row = 0;
  rival.filter.correct_fix(innovation, (scale_of(innovation) - 1.0) * covariance);
  rival.last_fix_ns = fix.time_ns;
  ++rival.fixes;
  return true;
}

/// Of a fix that neither the best filter nor the rival explains. Several in a row that form no track show
/// that the noise has grown. Without them it would stay small: most fixes are then rejected, and after a
/// rejection a used one says little about the noise.
void Belief::learn_from_scatter(const FixMeasurement& fix, const Innovation& innovation) {
  constexpr int several = 6;
  constexpr double most_m = 2.0;  // four times the largest noise that is learned
  constexpr int track = 3;        // fixes of a rival; when it ends, a track has ended
  if (phase != Phase::tracking || fix.has_covariance || fixes_rejected_in_row < several ||
      rival.fixes >= track || innovation.value_world_m.norm() > most_m)
    return;
  noise.add_scattered_fix(fix.quality_percent, innovation.value_world_m);
}

/// Whether the rival explained the fixes alone for long enough, or most of them for longer.
bool Belief::rival_has_won(TimeNs now_ns) const {
  const double jump_m =
      (rival.filter.tracked_position_world_m() - filter().tracked_position_world_m()).norm();
  constexpr double sees_turn_mps = 0.3;  // the fixes of a faster body show that its motion has turned
  constexpr int agreeing = 4;
  const double alone_s = seconds_between(std::max(last_fix_ns, rival.began_ns), now_ns);
  if (rival.has_turned && rival.fixes >= agreeing && rival.headings >= agreeing && alone_s > 0.4 &&
      rival.filter.velocity_world_mps.norm() > sees_turn_mps)
    return true;
  // The longer the best filter has explained none of the fixes, the sooner it is replaced.
  constexpr double credible_s = 3.0;
  constexpr int least_rejected = 16;
  const double credibility = credible_s / std::max(credible_s, unexplained_s(least_rejected, now_ns));
  const double needed_s =
      map_has_turned(now_ns)
          ? 1.0
          : std::max(std::clamp(2.2 - (jump_m - 1.5) / 0.5 * 1.2, 1.0, 2.2), wrong_tracks.wait_s(now_ns));
  const bool enough_fixes = rival.fixes >= 8 || (rival.fixes >= 3 && alone_s > 3.0);
  const bool explains_most = rival.fixes >= 16 && rival.fixes > 1.5 * rival.fixes_of_best &&
                             seconds_between(rival.began_ns, now_ns) > 4.0;
  return (alone_s >= needed_s * credibility && enough_fixes) || explains_most;
}

/// A rival that ended because the best filter explained the fixes again, or a track that was left for the
/// former one, was wrong. One that another rival replaced is not counted: the best filter explained none of
/// its fixes either.
void WrongTracks::add(double duration_s, TimeNs now_ns) {
  longest_s = std::max(duration_s, faded_s(now_ns));
  seen_ns = now_ns;
}

double WrongTracks::faded_s(TimeNs now_ns) const {
  constexpr double memory_s = 60.0;
  return longest_s * std::exp(-std::max(0.0, seconds_between(seen_ns, now_ns)) / memory_s);
}

/// For how long the next track must last to be believed.
double WrongTracks::wait_s(TimeNs now_ns) const {
  constexpr double margin = 1.3;
  constexpr double most_s = 1.6;
  return std::min(margin * faded_s(now_ns), most_s);
}

void Belief::end_rival(TimeNs now_ns) {
  constexpr int enough = 3;  // fixes of a track
  if (rival.alive && rival.fixes >= enough) {
    wrong_tracks.add(seconds_between(rival.began_ns, rival.last_fix_ns), now_ns);
  }
  rival.alive = false;
}

/// The track through this fix with the motion of the best filter; where no track has explained the fixes for
/// a while, or the best filter has jumped to a track that may be wrong, with an unknown motion.
void Belief::begin_rival(const FixMeasurement& fix, const Matrix3d& covariance) {
  constexpr double lost_s = 1.0;
  const bool again = rival.alive;
  rival.alive = true;
  rival.began_ns = fix.time_ns;
  rival.last_fix_ns = fix.time_ns;
  rival.fixes = 1;
  rival.misses_in_row = 0;
  rival.fixes_of_best = 0;
  rival.has_turned = false;
  rival.headings = 0;
  const bool open = seconds_between(last_fix_ns, fix.time_ns) > lost_s || map_has_turned(fix.time_ns) ||
                    (again && has_just_jumped(fix.time_ns));
  rival.filter = filter();
  Filter& f = rival.filter;
  f.position_world_m = fix.position_world_m + f.q_body_to_world * f.lever_arm_body_m;
  f.decorrelate(at_position, 2.0 * covariance.diagonal());
  if (!open) {
    // The motion of the best filter did not explain the fixes. They may have drifted away before they came
    // back: its velocity is then that of the drift.
    constexpr double drift_mps = 0.3;
    if (again) f.add_variance(at_velocity, Vector3d::Constant(square(drift_mps)));
    return;
  }
  f.decorrelate(at_velocity, Vector3d::Constant(square(2.0)));
  f.add_variance(at_attitude, Vector3d::Constant(square(radians(5.0))));
  f.add_yaw_variance(square(radians(15.0)));
  f.add_variance(at_gyro_bias, Vector3d::Constant(square(0.01)));
  f.add_variance(at_accel_bias, Vector3d::Constant(square(0.1)));
}

void Belief::promote_rival() {
  // A track that replaced the former a moment ago is less credible than the former itself.
  const bool has_better_former =
      former.alive && !former.is_anchor && seconds_between(former.left_ns, rival.last_fix_ns) < established_s;
  if (!has_better_former) keep_former(rival.last_fix_ns, rival.began_ns);
  adopt(rival.filter);
  if (map_has_turned(rival.last_fix_ns)) {
    if (!rival.has_turned) widen_yaw(radians(40.0));
    heading_rejected_since_ns = 0;
    headings_rejected_in_row = 0;
  }
  rival.alive = false;
  rest::restart(rest);
}

/// Whether this fix lies on the track that was given up, which is then followed again: the third one in a row
/// does, or the first that is nearer to it than chance explains.
bool Belief::take_back_former(const FixMeasurement& fix, const Matrix3d& covariance, double ahead_s) {
  if (!former.alive) return false;
  const Innovation innovation = former.filter.fix_innovation(fix.position_world_m, covariance, ahead_s);
  if (!(innovation.squared_norm <= rejected_above)) {
    former.fixes_in_row = 0;
    return false;
  }
  // An uncertain position near the filter's own is no evidence.
  constexpr double least_sigmas = 3.0;
  constexpr double anchor_sigmas = 6.0;
  constexpr double clear_sigmas = 10.0;
  const double std_m = std::sqrt(innovation.covariance_m2.diagonal().maxCoeff());
  const double sigmas = (fix.position_world_m - filter().tracked_position_world_m()).norm() / std_m;
  const double nearness = std::min(1.0, square(sigmas / anchor_sigmas));
  if (sigmas < least_sigmas || (former.is_anchor && innovation.squared_norm > nearness * full_weight_below)) {
    former.fixes_in_row = 0;
    return false;
  }
  const bool is_clear = innovation.squared_norm <= full_weight_below && sigmas > clear_sigmas;
  former.filter.correct_fix(innovation, (scale_of(innovation) - 1.0) * innovation.covariance_m2);
  const int enough = is_clear && !former.is_anchor ? 1 : 3;
  if (++former.fixes_in_row < enough) return false;
  if (!former.is_anchor) wrong_tracks.add(seconds_between(former.left_for_ns, fix.time_ns), fix.time_ns);
  adopt(former.filter);
  former.alive = false;
  rival.alive = false;
  note_jump(fix.time_ns);
  rest::restart(rest);
  return true;
}

/// Copies the best filter every few seconds while no former track is kept.
void Belief::drop_anchor(TimeNs now_ns) {
  constexpr double spacing_s = 5.0;
  if (phase != Phase::tracking || rival.alive) return;
  if (former.alive && (!former.is_anchor || seconds_between(former.left_ns, now_ns) < spacing_s)) return;
  keep_former(now_ns, 0);
  former.is_anchor = true;
}

/// Keeps the best filter as the former track, left at this time for a track that began at the other.
void Belief::keep_former(TimeNs left_ns, TimeNs left_for_ns) {
  former.alive = true;
  former.is_anchor = false;
  former.left_ns = left_ns;
  former.left_for_ns = left_for_ns;
  former.model = best;
  former.fixes_in_row = 0;
  former.filter = filter();
}

}  // namespace sonopose::estimation::kalman
