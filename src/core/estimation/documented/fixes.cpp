// Steps of the engine at a fix, in the order of the document; numbers are its items.

#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/estimation/aiding/planar.hpp>
#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/outputs.hpp>

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace sonopose::estimation::documented {

FixReport Engine::correct(const UltrasonicFix& measured) noexcept {
  finish_pending_work();
  FixReport report = report_on(measured, state_.body.time_ns);
  UltrasonicFix fix = measured;
  fix.position_world_m =
      aiding::position_in_plane(settings_.planar, measured.position_world_m, measured.point_body_m);
  report.trust = state_.trust.trust;
  report.flags = reject(fix);  // 12
  if (report.flags != 0) {
    ++counters_.fixes_rejected;
    return report;
  }
  fix = of_tracked_point(fix);
  fix.position_world_m = aiding::admission::completed_position(fix, state_.body.position_world_m);
  startup::update(state_.startup, fix);
  TimedFix timed = delay::extrapolated(settings_.delay, state_.body, fix);  // 6
  report.shifted_position_world_m = timed.shifted_position_world_m;
  scatter::learn(state_.scatter, state_.body, timed);
  if (state_.outage.init_phase == InitPhase::no_position) {
    reset_position(timed, report);
  } else {
    scatter::scale_innovation(trust::share_of(settings_.trust, state_.scatter.noise_world_m), state_.body,
                              timed);  // 13
    if (state_.outage.init_phase == InitPhase::tracking || !reset_velocity(timed, report)) {
      correct_pose(timed, report);
    }
  }
  state_.outage.last_valid_fix_ns = fix.received_time_ns;
  report.flags |= fix_used;
  ++counters_.fixes_used;
  return report;
}

/// Bits of FixFlag that exclude this fix; 0 if it is used.
std::uint32_t Engine::reject(const UltrasonicFix& fix) {
  const std::uint32_t flags =
      aiding::admission::rejection_flags(settings_.admission, state_.admission, state_.body.time_ns, fix,
                                         aiding::measured_at(settings_.delay, fix));
  const bool is_set = (fix.flags & ultrasonic_flag_set_pose) != 0;
  if (is_set) use_set_yaw(fix, flags == 0);
  if (flags != 0) return flags;
  if (is_set) {
    state_.outage.init_phase = InitPhase::no_position;
    return 0;
  }
  // Two tags that rest return to their positions too.
  if (fix.point_body_m.isZero(0.0) && is_default_position(fix)) return fix_outlier;
  const bool was_frozen = state_.frozen.frozen;
  if (frozen::update(settings_.frozen, state_.frozen, state_.body, fix)) return fix_frozen;
  // Repeated fixes before the detection have distorted the pose: this one initialises it.
  if (was_frozen) state_.outage.init_phase = InitPhase::no_position;
  return 0;
}

/// Uses the yaw of a pose that the user sets, if its fix is used: a refused pose changes nothing.
void Engine::use_set_yaw(const UltrasonicFix& fix, bool fix_is_used) {
  constexpr double max_apart_s = 0.1;
  const auto yaw = std::exchange(set_yaw_, std::nullopt);
  if (!yaw) return;
  const TimeNs measured_ns = aiding::measured_at(settings_.delay, *yaw);
  const double apart_s = seconds_between(measured_ns, aiding::measured_at(settings_.delay, fix));
  if (!fix_is_used || !(std::abs(apart_s) <= max_apart_s)) {
    ++counters_.samples_invalid;
    return;
  }
  ++counters_.headings;
  heading::set_target(settings_.heading, state_.heading, state_.body, state_.filter, *yaw, measured_ns);
}

/// Moves a fix from its point of the body to the tracked one.
UltrasonicFix Engine::of_tracked_point(const UltrasonicFix& fix) const {
  if (fix.point_body_m.isZero(0.0)) return fix;
  const Quaterniond q_now = state_.filter.orientation();
  const double yaw_now_rad = heading::yaw_by_pair(settings_.heading, q_now);
  const double yaw_then_rad =
      state_.body.yaw_at(aiding::measured_at(settings_.delay, fix)).value_or(yaw_now_rad);
  UltrasonicFix moved = fix;
  moved.position_world_m -=
      geometry::rotation_about_z(yaw_then_rad - yaw_now_rad) * (q_now * fix.point_body_m);
  moved.point_body_m.setZero();
  return moved;
}

/// Detects a position that the source reports when it has none. A pose that is there at the detection, or
/// that such fixes have misled, starts a new run at the next fix.
bool Engine::is_default_position(const UltrasonicFix& fix) {
  constexpr double near_m = 0.5;
  aiding::DefaultPosition& found = state_.default_position;
  const bool was_known = found.is_known;
  if (!found.add(aiding::measured_at(settings_.delay, fix), fix.position_world_m)) return false;
  const bool is_there = (state_.body.position_world_m - fix.position_world_m).norm() < near_m;
  if (!was_known) state_.scatter = ScatterState{};  // learned from default positions
  const bool is_misled = is_there || state_.trust.trust < 1.0 || !state_.velocity.settled();
  if (!was_known && is_misled) state_.outage.init_phase = InitPhase::no_position;
  return true;
}

/// Sets the position to this fix, and trusts it fully.
void Engine::move_to(const TimedFix& fix, FixReport& report) {
  report.jump_world_m = fix.shifted_position_world_m - state_.body.position_world_m;
  report.weight = 1.0;
  report.trust = 1.0;
  state_.body.position_world_m = fix.shifted_position_world_m;
  state_.drift = DriftState{};
  state_.runaway = {true, fix.shifted_position_world_m};
  trust::restart(state_.trust, fix);
}

/// Starts a run at its first fix.
void Engine::reset_position(const TimedFix& fix, FixReport& report) {
  const bool first = state_.outage.last_valid_fix_ns == 0;
  report.flags |= first ? fix_first : fix_stale_recovered;
  move_to(fix, report);
  if (!first) report.innovation_world_m = report.jump_world_m;
  uncertainty::reset_position(settings_.uncertainty, state_.uncertainty);
  // Just after a start at rest the velocity is known to be zero.
  const bool velocity_known =
      first && state_.startup.calibrated &&
      outage::is_recent(settings_.outage, state_.startup.ended_ns, state_.body.time_ns);
  velocity::restart(state_.velocity, fix, velocity_known);
  if (first) {
    state_.uncertainty.velocity_std_mps = velocity_known ? 0.0 : UncertaintyState::unknown_mps;
  }
  state_.outage.init_phase = velocity_known ? InitPhase::tracking : InitPhase::no_velocity;
  state_.outage.stale = false;
}

/// Sets the velocity from the second fix of a run; without it no position can be predicted. Returns false if
/// the two fixes are too close or too far apart in time to measure one.
bool Engine::reset_velocity(TimedFix& fix, FixReport& report) {
  const auto measured =
      velocity::measure(settings_.velocity, state_.velocity, state_.body, fix, FixAssessment{});
  if (!measured) return false;
  report.velocity_change_world_mps = velocity::initialise(state_.velocity, state_.body, *measured);
  delay::extrapolate_to_now(settings_.delay, state_.body, fix);
  report.shifted_position_world_m = fix.shifted_position_world_m;
  move_to(fix, report);
  uncertainty::correct(settings_.uncertainty, state_.uncertainty, 1.0, 1.0, 1.0, measured->interval_s);
  state_.outage.init_phase = InitPhase::tracking;
  return true;
}

/// Corrects position, velocity and yaw by a later fix, according to its weight.
void Engine::correct_pose(const TimedFix& fix, FixReport& report) {
  Kinematics& body = state_.body;
  const std::optional<int> velocities =
      state_.velocity.settled() ? std::nullopt : std::optional(state_.velocity.velocities);
  constexpr double max_yaw_std_rad = 1.0;
  const double yaw_error_mps = std::min(max_yaw_std_rad, state_.uncertainty.yaw_std_rad) *
                               state_.alignment.gained_world_mps.head<2>().norm();
  const FixAssessment assessment =
      trust::assess(settings_.trust, state_.trust, body, fix, velocities, yaw_error_mps);  // 13–22
  // A velocity from two fixes may be grossly wrong: the second outlier restarts the run.
  if (velocities && assessment.outlier && state_.trust.outliers_in_row > 1) {
    reset_position(fix, report);
    report.flags = (report.flags & ~std::uint32_t{fix_stale_recovered}) | fix_outlier;
    return;
  }
  report.innovation_world_m = assessment.innovation_world_m.cwiseQuotient(fix.share);
  report.test_ratio = assessment.test_ratio;
  report.weight = assessment.weight;
  report.trust = state_.trust.trust;
  if (assessment.outlier) report.flags |= fix_outlier;
  if (assessment.forced) report.flags |= fix_stuck_forced;

  runaway::update_reference(state_.runaway, fix, assessment);
  report.jump_world_m = drift::correct(settings_.drift, state_.drift, body, fix, assessment);  // 2, 4, 9
  const auto measured = velocity::measure(settings_.velocity, state_.velocity, body, fix, assessment);
  double interval_s = 0.0;
  double velocity_share = 0.0;
  if (measured) {
    const auto change = velocity::correct(settings_.velocity, state_.velocity, body, *measured,
                                          assessment);  // 3, 7, 8, 26–28
    report.velocity_change_world_mps = change.change_world_mps;
    report.flags |= change.flags;
    if (measured->by_rivals) {
      state_.alignment.gained_world_mps *= 1.0 - change.share;  // outliers may be wrong
    } else {
      align(fix, *measured, change, report);
      report.yaw_change_rad += heading::correct_from_course(settings_.heading, state_.heading, body,
                                                            state_.filter, *measured);  // 31–33
    }
    interval_s = measured->interval_s;
    velocity_share = change.share;
  }
  uncertainty::correct(settings_.uncertainty, state_.uncertainty, assessment.weight,
                       drift::jump_share(settings_.drift, assessment), velocity_share, interval_s);
}

/// Corrects the attitude from a velocity correction.
void Engine::align(const TimedFix& fix, const FixVelocity& measured, const VelocityChange& change,
                   FixReport& report) {
  // A snap and the first fixes of a run correct an unknown velocity, and others what the gate withheld. That
  // says nothing about the attitude.
  const bool was_gated = seconds_between(state_.alignment.gated_ns, fix.measured_ns) <= measured.interval_s;
  if (change.flags != 0 || !state_.velocity.settled() || was_gated) {
    state_.alignment.gained_world_mps.setZero();
    return;
  }
  alignment::correct_tilt(settings_.alignment, state_.alignment, state_.filter, change.change_world_mps);
  if (heading::is_valid(settings_.heading, state_.heading, state_.body.time_ns) ||
      attitude::has_magnetic_heading(settings_.attitude.selection)) {
    state_.alignment.gained_world_mps *= 1.0 - change.share;
  } else {
    const YawTurn yaw = alignment::correct_yaw(settings_.alignment, state_.alignment, state_.body,
                                               state_.filter, measured, change.share);
    report.yaw_change_rad = yaw.turn_rad;
    uncertainty::align_yaw(state_.uncertainty, yaw.share, yaw.std_rad);
  }
}

}  // namespace sonopose::estimation::documented
