#include <sonopose/estimation/documented/engine.hpp>

// The way of a fix and of a pair heading through the stages; that of an IMU sample stands in engine.cpp.

namespace sonopose::estimation::documented {

FixReport Engine::on(const UltrasonicFix& fix) noexcept {
  FixReport report;
  report.address = fix.address;
  report.sequence = fix.sequence;
  report.emission_time_ns = fix.emission_time_ns;
  report.applied_time_ns = state_.body.time_ns;
  report.position_world_m = fix.position_world_m;
  report.trust = state_.trust.trust;

  report.flags = admission::reasons_against(settings_.admission, state_.admission, state_.body.time_ns, fix,
                                            delay::measured_at(settings_.delay, fix));
  const bool was_frozen = state_.frozen.frozen;
  if (report.flags == 0 && frozen::watch(settings_.frozen, state_.frozen, state_.body, fix)) {
    report.flags = fix_frozen;
  }
  if (report.flags != 0) {
    ++counters_.fixes_rejected;
    return report;
  }
  // What a track repeated before it was found out to be frozen has bent the pose: begin anew.
  if (was_frozen) state_.outage.track = InitPhase::none;
  startup::watch(settings_.startup, state_.startup, fix);
  TimedFix timed = delay::shift(settings_.delay, state_.body, fix);  // 6
  if (state_.outage.track == InitPhase::none) {
    reset_position(timed, report);
  } else if (state_.outage.track == InitPhase::held || !reset_velocity(timed, report)) {
    apply_fix(timed, report);
  }
  report.shifted_position_world_m = timed.shifted_position_world_m;
  state_.outage.last_valid_fix_ns = fix.received_time_ns;
  state_.runaway = {true, timed.shifted_position_world_m};
  report.flags |= fix_used;
  ++counters_.fixes_used;
  return report;
}

void Engine::on(const PairHeading& heading) noexcept {
  const TimeNs measured_ns = delay::measured_at(settings_.delay, heading);  // 6
  if (!admission::admits(settings_.admission, state_.body.time_ns, heading, measured_ns)) {
    ++counters_.samples_invalid;
    return;
  }
  ++counters_.headings;
  if (state_.frozen.frozen) return;  // it comes from the same fixes
  heading::take(settings_.heading, state_.heading, state_.body, state_.filter, heading, measured_ns);  // 5
}

/// The first fix of a run sets the position, trust begins anew.
void Engine::reset_position(const TimedFix& fix, FixReport& report) {
  const bool first = state_.outage.last_valid_fix_ns == 0;
  report.flags |= first ? fix_first : fix_stale_recovered;
  report.jump_world_m = fix.shifted_position_world_m - state_.body.position_world_m;
  if (!first) report.innovation_world_m = report.jump_world_m;
  report.weight = 1.0;
  report.trust = 1.0;
  state_.body.position_world_m = fix.shifted_position_world_m;
  state_.drift = DriftState{};
  trust::restart(state_.trust, fix);
  uncertainty::reset_position(settings_.uncertainty, state_.uncertainty);
  // Just after a start at rest the velocity is known already: zero.
  const bool velocity_known =
      first && state_.startup.calibrated &&
      outage::is_recent(settings_.outage, state_.startup.ended_ns, state_.body.time_ns);
  velocity::restart(state_.velocity, fix, velocity_known);
  if (first) {
    state_.uncertainty.velocity_std_mps = velocity_known ? 0.0 : UncertaintyState::unknown_mps;
  }
  state_.outage.track = velocity_known ? InitPhase::held : InitPhase::position;
  state_.outage.stale = false;
}

/// The second fix of a run sets the velocity: until then there is none that could predict where it should
/// lie. False where the two stand too near or too far apart in time for a velocity.
bool Engine::reset_velocity(TimedFix& fix, FixReport& report) {
  const auto measured =
      velocity::measure(settings_.velocity, state_.velocity, state_.body, fix, FixAssessment{});
  if (!measured) return false;
  report.velocity_change_world_mps = velocity::adopt(state_.velocity, state_.body, *measured);
  delay::move_on(settings_.delay, state_.body, fix);
  report.jump_world_m = fix.shifted_position_world_m - state_.body.position_world_m;
  report.weight = 1.0;
  report.trust = 1.0;
  state_.body.position_world_m = fix.shifted_position_world_m;
  state_.drift = DriftState{};
  trust::restart(state_.trust, fix);
  uncertainty::correct(settings_.uncertainty, state_.uncertainty, 1.0, 1.0, 1.0, measured->interval_s);
  state_.outage.track = InitPhase::held;
  return true;
}

/// Every later fix corrects position, velocity and yaw by what it is worth.
void Engine::apply_fix(const TimedFix& fix, FixReport& report) {
  Kinematics& body = state_.body;
  const FixAssessment assessment = trust::judge(settings_.trust, state_.trust, body, fix);  // 13–22
  report.innovation_world_m = assessment.innovation_world_m;
  report.weight = assessment.weight;
  report.trust = state_.trust.trust;
  if (assessment.outlier) report.flags |= fix_outlier;
  if (assessment.forced) report.flags |= fix_stuck_forced;

  report.jump_world_m = drift::correct(settings_.drift, state_.drift, body, fix, assessment);  // 2, 4, 9
  const auto measured = velocity::measure(settings_.velocity, state_.velocity, body, fix, assessment);
  double interval_s = 0.0;
  double velocity_share = 0.0;
  if (measured) {
    const auto change = velocity::correct(settings_.velocity, state_.velocity, body, *measured,
                                          assessment);  // 3, 7, 8, 26–28
    report.velocity_change_world_mps = change.change_world_mps;
    report.flags |= change.flags;
    align(*measured, change, report);
    report.yaw_change_rad += heading::correct_from_course(settings_.heading, state_.heading, body,
                                                          state_.filter, *measured);  // 31–33
    interval_s = measured->interval_s;
    velocity_share = change.share;
  }
  uncertainty::correct(settings_.uncertainty, state_.uncertainty, assessment.weight,
                       drift::jump_share(settings_.drift, assessment), velocity_share, interval_s);
}

/// What a velocity correction tells of the attitude.
void Engine::align(const FixVelocity& measured, const VelocityChange& change, FixReport& report) {
  // A snap, and the first fixes of a run, mend a velocity that was not known, whatever the attitude.
  if (change.flags != 0 || !state_.velocity.settled()) {
    state_.alignment.gained_world_mps.setZero();
    return;
  }
  alignment::level(settings_.alignment, state_.alignment, state_.filter, change.change_world_mps);
  if (heading::is_valid(settings_.heading, state_.heading, state_.body.time_ns) ||
      attitude::has_magnetic_heading(settings_.attitude.selection)) {
    state_.alignment.gained_world_mps *= 1.0 - change.share;
  } else {
    report.yaw_change_rad = alignment::turn(settings_.alignment, state_.alignment, state_.body, state_.filter,
                                            measured, change.share);
  }
}

}  // namespace sonopose::estimation::documented
