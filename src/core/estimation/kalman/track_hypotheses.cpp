// Fixes that the best hypothesis rejects: the track that they form, and the track followed before.

#include "estimation/kalman/state_internal.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sonopose::estimation::kalman {
namespace {

constexpr TimeNs converging_ns = 500'000'000;  // after a jump

/// True if the other track explained the fixes alone for long enough.
bool is_confirmed(const State& state, const Hypothesis& other, TimeNs now_ns) {
  constexpr int min_turned = 4;  // fixes and headings in a map that has turned
  constexpr double min_turned_s = 0.4;
  constexpr double min_turned_speed_mps = 0.3;  // the fixes of a faster body show that its motion has turned
  constexpr int min_fixes = 8;
  const double alone_s = seconds_between(std::max(state.fixes.used_ns, other.began_ns), now_ns);
  if (other.track == Track::turned && std::min(other.explained, other.headings) >= min_turned &&
      alone_s > min_turned_s && other.filter.velocity_world_mps.norm() > min_turned_speed_mps)
    return true;
  const double jump_m =
      (other.filter.tracked_position_world_m() - state.filter().tracked_position_world_m()).norm();
  // Reflections are mostly near: a track further away is believed sooner.
  constexpr double near_m = 1.5;
  constexpr double far_m = 2.0;
  constexpr double near_s = 2.2;
  constexpr double far_s = 1.0;
  const double nearness = std::clamp((far_m - jump_m) / (far_m - near_m), 0.0, 1.0);
  const double needed_s = std::max(far_s + nearness * (near_s - far_s), state.wrong_tracks.wait_s(now_ns));
  return alone_s >= needed_s && other.explained >= min_fixes;
}

/// True if the fixes contradict the first one: soon after a start the best filter accepts much.
bool start_was_wrong(const State& state, const Hypothesis& other) {
  return state.fixes.since_start < proven_fixes && other.explained >= min_track_fixes &&
         other.explained > state.fixes.since_start;
}

/// Starts the track at this fix, with the motion of the best filter.
void begin_other_track(State& state, const JudgedFix& judged) {
  const Hypothesis* const before = find_other_track(state);
  const bool again = before != nullptr;
  if (again) state.bank.remove(before);
  Hypothesis& other = state.bank.spawn(state.bank.best());
  other.track = Track::other;
  other.explained = 1;
  other.missed_in_row = other.headings = 0;
  other.began_ns = other.explained_ns = judged.fix.time_ns;
  Filter& f = other.filter;
  f.position_world_m = tracked_at(judged.fix, f) + f.q_body_to_world * f.lever_arm_body_m;
  f.decorrelate(at_position, 2.0 * judged.covariance_m2.diagonal());
  // The motion of the best filter did not explain the fixes. They may have drifted away before they returned;
  // its velocity is then that of the drift.
  if (again) inflate(f, {.velocity_mps = 0.3});
}

/// Corrects the other track by a fix that it explains. A fix that it does not explain starts it, or counts as
/// a miss.
bool other_track_explains(State& state, const JudgedFix& judged, FixOutcome& outcome) {
  Hypothesis* const other = find_other_track(state);
  if (other == nullptr) {
    begin_other_track(state, judged);
    return false;
  }
  const Innovation& innovation = judged.innovation_of(state.bank, *other);
  if (!(innovation.squared_norm <= chi2_reject_threshold)) {
    // A track that many fixes support survives a short spike.
    const int max_misses = 3 + std::min(other->explained / 2, 9);
    if (++other->missed_in_row >= max_misses) begin_other_track(state, judged);
    return false;
  }
  outcome.hypothesis = 1;
  other->missed_in_row = 0;
  correct_scaled(other->filter, innovation, judged.covariance_m2);
  other->explained_ns = judged.fix.time_ns;
  ++other->explained;
  return true;
}

/// Follows this track and no other.
void follow(State& state, const Hypothesis& track) {
  state.bank.follow(track.filter);
  state.bank.remove(Track::other);
  state.bank.remove(Track::turned);
  rest::restart(state.rest);
}

void promote_other_track(State& state) {
  const Hypothesis* const other = find_other_track(state);
  if (other->track == Track::turned) state.headings.accept();
  store_former_track(state, other->explained_ns, other->began_ns);
  follow(state, *find_other_track(state));
}

/// True if this fix lies on the abandoned track, which is then followed again. It takes three in a row, or
/// one that is nearer to it than chance explains.
bool resume_former_track(State& state, const JudgedFix& judged) {
  Hypothesis* const former = state.bank.find(Track::former);
  if (former == nullptr) return false;
  const Innovation& innovation = judged.innovation_of(state.bank, *former);
  // An uncertain position near the filter's own is no evidence.
  constexpr double min_sigmas = 3.0;
  constexpr double clear_sigmas = 10.0;
  const double std_m = std::sqrt(innovation.covariance_m2.diagonal().maxCoeff());
  const double sigmas =
      (tracked_at(judged.fix, state.filter()) - state.filter().tracked_position_world_m()).norm() / std_m;
  if (!(innovation.squared_norm <= chi2_reject_threshold) || sigmas < min_sigmas) {
    former->explained_in_row = 0;
    return false;
  }
  const bool is_clear = innovation.squared_norm <= chi2_huber_threshold && sigmas > clear_sigmas;
  correct_scaled(former->filter, innovation, innovation.covariance_m2);
  if (++former->explained_in_row < (is_clear ? 1 : min_track_fixes)) return false;
  state.wrong_tracks.add(seconds_between(former->began_ns, judged.fix.time_ns), judged.fix.time_ns);
  follow(state, *former);
  state.bank.remove(Track::former);
  note_jump(state, judged.fix.time_ns);
  return true;
}

}  // namespace

Hypothesis* find_other_track(State& state) {
  Hypothesis* const turned = state.bank.find(Track::turned);
  return turned != nullptr ? turned : state.bank.find(Track::other);
}

void judge_rejected(State& state, const JudgedFix& judged, FixOutcome& outcome) {
  outcome.flags = fix_outlier;
  state.fixes.rejected_world_m = tracked_at(judged.fix, state.filter());
  state.fixes.rejected_ns = judged.fix.time_ns;
  if (!resume_former_track(state, judged)) {
    if (!other_track_explains(state, judged, outcome)) return;
    const Hypothesis& other = *find_other_track(state);
    const bool starts_again = start_was_wrong(state, other);
    if (!starts_again && !is_confirmed(state, other, judged.fix.time_ns)) return;
    // While yaw is searched, the other track copies one of the starts, whose yaw is arbitrary.
    if (starts_again || state.phase == Phase::searching_yaw) {
      start_at(state, judged.fix, judged.settings);
    } else {
      promote_other_track(state);
    }
    note_jump(state, judged.fix.time_ns);
    outcome.flags |= fix_stuck_forced;
  }
  outcome.flags = (outcome.flags & ~std::uint32_t{fix_outlier}) | fix_used;
  outcome.weight = 1.0;
}

void end_other_track(State& state, TimeNs now_ns) {
  const Hypothesis* const other = find_other_track(state);
  if (other == nullptr) return;
  if (other->explained >= min_track_fixes) {
    state.wrong_tracks.add(seconds_between(other->began_ns, other->explained_ns), now_ns);
  }
  state.bank.remove(other);
}

void store_former_track(State& state, TimeNs left_ns, TimeNs left_for_ns) {
  state.bank.remove(Track::former);
  Hypothesis& former = state.bank.spawn(state.bank.best());
  former.track = Track::former;
  former.began_ns = left_for_ns;
  former.explained_ns = left_ns;
  former.explained_in_row = 0;
}

void note_jump(State& state, TimeNs fix_ns) {
  state.converging_until_ns = std::max(state.imu.time_ns, fix_ns) + converging_ns;
  state.fixes.used_ns = fix_ns;
  state.fixes.rejected_in_row = 0;
  state.fixes.misfits_in_row = 0;
  state.imu_fault.forget_innovations();
}

/// Judges the hypothesis that the map has turned suddenly. It starts with the second consecutive heading that
/// is rejected together with the fixes: the other track, with its motion turned. Later headings correct it.
void judge_turned_map(State& state, const settings::Settings& settings, const HeadingMeasurement& heading,
                      double innovation_rad) {
  constexpr double same_turn_s = 0.5;
  constexpr double oldest_fix_s = 0.2;  // time over which the velocity moves it
  Hypothesis* const other = find_other_track(state);
  if (other == nullptr) return;
  const double variance = variance_of(state, heading);
  if (other->track == Track::turned) {
    const auto innovation = heading_innovation(state, other->filter, settings, heading);
    if (!innovation.observable) return;
    if (squared_norm(innovation) > heading_chi2_reject_threshold) {
      other->track = Track::other;
      return;
    }
    ++other->headings;
    correct_by_heading(state, other->filter, settings, heading, variance);
    return;
  }
  const HeadingGate& gate = state.headings;
  const bool starts_now = gate.rejected_in_row == 2 &&
                          seconds_between(gate.rejected_since_ns, other->began_ns) < same_turn_s &&
                          seconds_between(gate.used_ns, gate.rejected_since_ns) < gate.rejection_timeout_s();
  const double fix_age_s = seconds_between(state.fixes.rejected_ns, heading.time_ns);
  if (!starts_now || state.fixes.rejected_in_row == 0 || fix_age_s > oldest_fix_s) return;
  *other = state.bank.best();
  other->track = Track::turned;
  other->explained = 1;
  other->missed_in_row = other->headings = 0;
  other->began_ns = other->explained_ns = gate.rejected_since_ns;
  Filter& f = other->filter;
  f.turn_world(innovation_rad);
  f.position_world_m = state.fixes.rejected_world_m + f.q_body_to_world * f.lever_arm_body_m +
                       seconds_between(state.fixes.rejected_ns, state.time_ns) * f.velocity_world_mps;
  f.decorrelate(at_position, 2.0 * state.noise.fix_covariance_m2(state.fixes.quality_percent).diagonal());
  f.add_yaw_variance(variance);
}

// Wrong tracks

/// Adds a track that was wrong: the best filter explained the fixes again, or the former track was followed
/// again. A track that was replaced by another one does not count.
void WrongTracks::add(double duration_s, TimeNs now_ns) {
  longest_s = std::max(duration_s, faded_s(now_ns));
  seen_ns = now_ns;
}

double WrongTracks::faded_s(TimeNs now_ns) const {
  constexpr double memory_s = 60.0;
  return longest_s * std::exp(-std::max(0.0, seconds_between(seen_ns, now_ns)) / memory_s);
}

double WrongTracks::wait_s(TimeNs now_ns) const {
  constexpr double margin = 1.3;
  constexpr double max_s = 1.6;
  return std::min(margin * faded_s(now_ns), max_s);
}

}  // namespace sonopose::estimation::kalman
