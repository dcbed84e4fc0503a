#pragma once
/// \file
/// Every field of the engine's state by name, to save, restore and hash it, in the order of the hash. A test
/// compares the number of names in each group with the number of its fields.

#include <sonopose/estimation/documented/state.hpp>
#include <sonopose/samples/field_fault.hpp>

#include <optional>

namespace sonopose::estimation::documented {

void for_each_field(IsFieldsOf<PastFix> auto& fix, const auto& visit) {
  visit("measured_ns", fix.measured_ns);
  visit("position_world_m", fix.position_world_m);
}

void for_each_field(IsFieldsOf<InertialPoint> auto& point, const auto& visit) {
  visit("time_ns", point.time_ns);
  visit("displacement_world_m", point.displacement_world_m);
  visit("yaw_rad", point.yaw_rad);
}

/// Calls `visit(name, field)` for each field. Fields are bool, int, TimeNs, double, Vector3d, InitPhase,
/// attitude::AnyFilter, InertialHistory and arrays of PastFix and of Coordinates.
void for_each_field(IsFieldsOf<State> auto& state, const auto& visit) {
  visit("body.time_ns", state.body.time_ns);
  visit("body.position_world_m", state.body.position_world_m);
  visit("body.velocity_world_mps", state.body.velocity_world_mps);
  visit("body.velocity_corrections_world_mps", state.body.velocity_corrections_world_mps);
  visit("body.displacement_world_m", state.body.displacement_world_m);
  visit("body.yaw_corrections_rad", state.body.yaw_corrections_rad);
  visit("body.acceleration_world_mps2", state.body.acceleration_world_mps2);
  visit("body.angular_velocity_body_radps", state.body.angular_velocity_body_radps);
  visit("body.history", state.body.history);

  visit("filter", state.filter);

  visit("startup.began_ns", state.startup.began_ns);
  visit("startup.window_began_ns", state.startup.window_began_ns);
  visit("startup.window_samples", state.startup.window_samples);
  visit("startup.gyro_mean", state.startup.gyro_mean);
  visit("startup.gyro_squares", state.startup.gyro_squares);
  visit("startup.accel_mean", state.startup.accel_mean);
  visit("startup.accel_squares", state.startup.accel_squares);
  visit("startup.window_fixes", state.startup.window_fixes);
  visit("startup.fix_time_mean_s", state.startup.fix_time_mean_s);
  visit("startup.fix_time_squares_s2", state.startup.fix_time_squares_s2);
  visit("startup.fix_mean_world_m", state.startup.fix_mean_world_m);
  visit("startup.fix_squares_m2", state.startup.fix_squares_m2);
  visit("startup.fix_products_ms", state.startup.fix_products_ms);
  visit("startup.waiting", state.startup.waiting);
  visit("startup.calibrated", state.startup.calibrated);
  visit("startup.ended_ns", state.startup.ended_ns);
  visit("startup.gyro_offset_body_radps", state.startup.gyro_offset_body_radps);

  visit("admission.backward_in_row", state.admission.backward_in_row);
  visit("admission.last_fix_measured_ns", state.admission.last_fix_measured_ns);
  visit("admission.announced_ns", state.admission.announced_ns);
  visit("admission.ahead_in_row", state.admission.ahead_in_row);

  visit("default_position.recent", state.default_position.recent);
  visit("default_position.fixes", state.default_position.fixes);
  visit("default_position.is_known", state.default_position.is_known);
  visit("default_position.default_world_m", state.default_position.default_world_m);
  visit("default_position.seen_ns", state.default_position.seen_ns);
  visit("default_position.in_row", state.default_position.in_row);

  visit("frozen.has_fix", state.frozen.has_fix);
  visit("frozen.frozen", state.frozen.frozen);
  visit("frozen.repeats", state.frozen.repeats);
  visit("frozen.coordinates_world_m", state.frozen.coordinates_world_m);
  visit("frozen.window_began_ns", state.frozen.window_began_ns);
  visit("frozen.window_displacement_world_m", state.frozen.window_displacement_world_m);
  visit("frozen.window_corrections_world_mps", state.frozen.window_corrections_world_mps);

  visit("scatter.noise_world_m", state.scatter.noise_world_m);
  visit("scatter.learned", state.scatter.learned);
  visit("scatter.last_measured_ns", state.scatter.last_measured_ns);
  visit("scatter.last_position_world_m", state.scatter.last_position_world_m);
  visit("scatter.last_excess_world_mps", state.scatter.last_excess_world_mps);

  visit("trust.trust", state.trust.trust);
  visit("trust.rebuild_n", state.trust.rebuild_n);
  visit("trust.rebuilt", state.trust.rebuilt);
  visit("trust.since_loss", state.trust.since_loss);
  visit("trust.outliers_in_row", state.trust.outliers_in_row);
  visit("trust.forced", state.trust.forced);
  visit("trust.has_last", state.trust.has_last);
  visit("trust.last_measured_ns", state.trust.last_measured_ns);
  visit("trust.last_position_world_m", state.trust.last_position_world_m);
  visit("trust.rivals", state.trust.rivals);
  visit("trust.strays", state.trust.strays);
  visit("trust.rival_measured_ns", state.trust.rival_measured_ns);
  visit("trust.rival_position_world_m", state.trust.rival_position_world_m);
  visit("trust.rival_excess_world_mps", state.trust.rival_excess_world_mps);
  visit("trust.rival_offset_world_m", state.trust.rival_offset_world_m);

  visit("drift.offset_world_m", state.drift.offset_world_m);
  visit("drift.velocity_world_mps", state.drift.velocity_world_mps);
  visit("drift.weight", state.drift.weight);

  visit("velocity.fixes", state.velocity.fixes);
  visit("velocity.count", state.velocity.count);
  visit("velocity.rivals", state.velocity.rivals);
  visit("velocity.rival_count", state.velocity.rival_count);
  visit("velocity.velocities", state.velocity.velocities);

  visit("alignment.vertical_offset_mps2", state.alignment.vertical_offset_mps2);
  visit("alignment.gained_world_mps", state.alignment.gained_world_mps);
  visit("alignment.pending_world_mps", state.alignment.pending_world_mps);
  visit("alignment.known_acceleration_world_mps2", state.alignment.known_acceleration_world_mps2);
  visit("alignment.aiding", state.alignment.aiding);
  visit("alignment.aided_ns", state.alignment.aided_ns);
  visit("alignment.gated_ns", state.alignment.gated_ns);

  visit("heading.known", state.heading.known);
  visit("heading.last_received_ns", state.heading.last_received_ns);
  visit("heading.wanted_correction_rad", state.heading.wanted_correction_rad);
  visit("heading.rate_offset_radps", state.heading.rate_offset_radps);

  visit("outage.last_valid_fix_ns", state.outage.last_valid_fix_ns);
  visit("outage.init_phase", state.outage.init_phase);
  visit("outage.stale", state.outage.stale);

  visit("runaway.has_fix", state.runaway.has_fix);
  visit("runaway.fix_position_world_m", state.runaway.fix_position_world_m);

  visit("uncertainty.position_std_m", state.uncertainty.position_std_m);
  visit("uncertainty.velocity_std_mps", state.uncertainty.velocity_std_mps);
  visit("uncertainty.yaw_std_rad", state.uncertainty.yaw_std_rad);

  visit("previous_rate_body_radps", state.previous_rate_body_radps);
  visit("in_imu_gap", state.in_imu_gap);
}

/// Visits the fields of the state. The counters are listed in samples/estimator_counters.hpp.
void for_each_field(IsFieldsOf<Snapshot> auto& snapshot, const auto& visit) {
  for_each_field(snapshot.state, visit);
}

/// First field with a value that its type allows but no engine can have.
inline std::optional<FieldFault> find_fault(const Snapshot& snapshot) {
  const State& state = snapshot.state;
  if (!(state.trust.trust >= 0.0 && state.trust.trust <= 1.0)) {
    return FieldFault{"trust.trust", "is not between 0 and 1"};
  }
  if (state.default_position.fixes < 0 ||
      state.default_position.fixes >= 2 * static_cast<int>(aiding::DefaultPosition::capacity)) {
    return FieldFault{"default_position.fixes", "is not between 0 and twice the number of places"};
  }
  if (!(state.scatter.noise_world_m.minCoeff() > 0.0)) {
    return FieldFault{"scatter.noise_world_m", "is not positive"};
  }
  if (state.scatter.learned < 0 || state.scatter.learned > ScatterState::samples_to_learn) {
    return FieldFault{"scatter.learned", "is not between 0 and samples_to_learn"};
  }
  if (state.velocity.count < 0 || state.velocity.count > VelocityState::capacity) {
    return FieldFault{"velocity.count", "is more than the number of fixes"};
  }
  if (state.velocity.rival_count < 0 || state.velocity.rival_count > VelocityState::capacity) {
    return FieldFault{"velocity.rival_count", "is more than the number of fixes"};
  }
  return std::nullopt;
}

}  // namespace sonopose::estimation::documented
