#pragma once
/// \file
/// Walks over every field of an engine's state by name, to save, restore and digest it. Each group is taken
/// apart with as many names as it has fields, so that a new field which is not listed here does not compile.

#include <sonopose/estimation/documented/state.hpp>

namespace sonopose::estimation::documented {

/// Calls `visit(name, field)` for each field; `AnyState` is State or const State. Fields are bool, int,
/// TimeNs, double, Vector3d, InitPhase, attitude::AnyFilter, InertialHistory and PastFix.
template <class AnyState, class Visit>
void for_each_field(AnyState& state, const Visit& visit) {
  auto& [body, filter, startup, admission, frozen, trust, drift, velocity, alignment, heading, outage,
         runaway, uncertainty, previous_rate_body_radps, in_imu_gap] = state;
  {
    auto& [time_ns, position, speed, corrections, displacement, yaw_corrections, acceleration, rate,
           history] = body;
    visit("body.time_ns", time_ns);
    visit("body.position_world_m", position);
    visit("body.velocity_world_mps", speed);
    visit("body.velocity_corrections_world_mps", corrections);
    visit("body.displacement_world_m", displacement);
    visit("body.yaw_corrections_rad", yaw_corrections);
    visit("body.acceleration_world_mps2", acceleration);
    visit("body.angular_velocity_body_radps", rate);
    visit("body.history", history);
  }
  visit("filter", filter);
  {
    auto& [began, window_began, samples, gyro_mean, gyro_squares, accel_mean, accel_squares, has_fix, fix,
           moved, waiting, calibrated, ended, offset] = startup;
    visit("startup.began_ns", began);
    visit("startup.window_began_ns", window_began);
    visit("startup.window_samples", samples);
    visit("startup.gyro_mean", gyro_mean);
    visit("startup.gyro_squares", gyro_squares);
    visit("startup.accel_mean", accel_mean);
    visit("startup.accel_squares", accel_squares);
    visit("startup.window_has_fix", has_fix);
    visit("startup.window_fix_world_m", fix);
    visit("startup.window_moved", moved);
    visit("startup.waiting", waiting);
    visit("startup.calibrated", calibrated);
    visit("startup.ended_ns", ended);
    visit("startup.gyro_offset_body_radps", offset);
  }
  {
    auto& [backward, last_fix, announced] = admission;
    visit("admission.backward_in_row", backward);
    visit("admission.last_fix_measured_ns", last_fix);
    visit("admission.announced_ns", announced);
  }
  {
    auto& [has_fix, is_frozen, repeats, coordinates, began, displacement, corrections] = frozen;
    visit("frozen.has_fix", has_fix);
    visit("frozen.frozen", is_frozen);
    visit("frozen.repeats", repeats);
    visit("frozen.coordinates_world_m", coordinates);
    visit("frozen.window_began_ns", began);
    visit("frozen.window_displacement_world_m", displacement);
    visit("frozen.window_corrections_world_mps", corrections);
  }
  {
    auto& [value, rebuild_n, rebuilt, since_loss, outliers, forced, has_last, last_ns, last] = trust;
    visit("trust.trust", value);
    visit("trust.rebuild_n", rebuild_n);
    visit("trust.rebuilt", rebuilt);
    visit("trust.since_loss", since_loss);
    visit("trust.outliers_in_row", outliers);
    visit("trust.forced", forced);
    visit("trust.has_last", has_last);
    visit("trust.last_measured_ns", last_ns);
    visit("trust.last_position_world_m", last);
  }
  {
    auto& [offset, speed, weight] = drift;
    visit("drift.offset_world_m", offset);
    visit("drift.velocity_world_mps", speed);
    visit("drift.weight", weight);
  }
  {
    auto& [fixes, count, velocities] = velocity;
    for (auto& fix : fixes) visit("velocity.fixes", fix);
    visit("velocity.count", count);
    visit("velocity.velocities", velocities);
  }
  {
    auto& [vertical, gained, pending, known, tells, told_ns] = alignment;
    visit("alignment.vertical_offset_mps2", vertical);
    visit("alignment.gained_world_mps", gained);
    visit("alignment.pending_world_mps", pending);
    visit("alignment.known_acceleration_world_mps2", known);
    visit("alignment.tells", tells);
    visit("alignment.told_ns", told_ns);
  }
  {
    auto& [known, received, wanted, rate_offset] = heading;
    visit("heading.known", known);
    visit("heading.last_received_ns", received);
    visit("heading.wanted_correction_rad", wanted);
    visit("heading.rate_offset_radps", rate_offset);
  }
  {
    auto& [last_fix, track, stale] = outage;
    visit("outage.last_valid_fix_ns", last_fix);
    visit("outage.track", track);
    visit("outage.stale", stale);
  }
  {
    auto& [has_fix, fix] = runaway;
    visit("runaway.has_fix", has_fix);
    visit("runaway.fix_position_world_m", fix);
  }
  {
    auto& [position_std, velocity_std, yaw_std] = uncertainty;
    visit("uncertainty.position_std_m", position_std);
    visit("uncertainty.velocity_std_mps", velocity_std);
    visit("uncertainty.yaw_std_rad", yaw_std);
  }
  visit("previous_rate_body_radps", previous_rate_body_radps);
  visit("in_imu_gap", in_imu_gap);
}

}  // namespace sonopose::estimation::documented
