#pragma once
/// \file
/// Every field of a snapshot by name, to save, restore and hash it. The order is the order of the hash.

#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/samples/field_fault.hpp>

#include <concepts>
#include <optional>
#include <type_traits>

namespace sonopose::estimation::kalman {

void for_each_field(IsFieldsOf<ImuMeasurement> auto& imu, const auto& visit) {
  visit("time_ns", imu.time_ns);
  visit("rate_body_radps", imu.rate_body_radps);
  visit("force_body_mps2", imu.force_body_mps2);
  visit("is_mean", imu.is_mean);
}

void for_each_field(IsFieldsOf<FixMeasurement> auto& fix, const auto& visit) {
  visit("time_ns", fix.time_ns);
  visit("stamp_ns", fix.stamp_ns);
  visit("position_world_m", fix.position_world_m);
  visit("quality_percent", fix.quality_percent);
  visit("has_covariance", fix.has_covariance);
  visit("covariance_world_m2", fix.covariance_world_m2);
}

void for_each_field(IsFieldsOf<HeadingMeasurement> auto& heading, const auto& visit) {
  visit("time_ns", heading.time_ns);
  visit("stamp_ns", heading.stamp_ns);
  visit("heading_world_rad", heading.heading_world_rad);
}

void for_each_field(IsFieldsOf<Transition> auto& transition, const auto& visit) {
  visit("duration_s", transition.duration_s);
  visit("position_velocity_s", transition.position_velocity_s);
  visit("shock_variance_m2ps2", transition.shock_variance_m2ps2);
  visit("rotation_start", transition.rotation_start);
  visit("impulse_mps", transition.impulse_mps);
  visit("impulse_sum_m", transition.impulse_sum_m);
  visit("rotation_sum_s", transition.rotation_sum_s);
  visit("rotation_double_sum_s2", transition.rotation_double_sum_s2);
  visit("velocity_gyro_bias", transition.velocity_gyro_bias);
  visit("position_gyro_bias", transition.position_gyro_bias);
}

/// In every belief that is kept, the state is that of the latest sample, and all filters have made all steps.
void for_each_field(IsFieldsOf<Filter> auto& filter, const auto& visit) {
  visit("position_world_m", filter.position_world_m);
  visit("velocity_world_mps", filter.velocity_world_mps);
  visit("q_body_to_world", filter.q_body_to_world);
  visit("gyro_bias_body_radps", filter.gyro_bias_body_radps);
  visit("accel_bias_body_mps2", filter.accel_bias_body_mps2);
  visit("lever_arm_body_m", filter.lever_arm_body_m);
  visit("delay_error_s", filter.delay_error_s);
  visit("delay_variance_s2", filter.delay_variance_s2);
  const auto visit_part = [&](const char* name, StateIndex index) {
    Vector3d part = filter.delay_covariance.template segment<3>(index);
    visit(name, part);
    if constexpr (!std::is_const_v<std::remove_reference_t<decltype(filter)>>) {
      filter.delay_covariance.template segment<3>(index) = part;
    }
  };
  visit_part("delay_covariance.position", at_position);
  visit_part("delay_covariance.velocity", at_velocity);
  visit_part("delay_covariance.attitude", at_attitude);
  visit_part("delay_covariance.gyro_bias", at_gyro_bias);
  visit_part("delay_covariance.accel_bias", at_accel_bias);
  visit_part("delay_covariance.lever_arm", at_lever_arm);
  visit("covariance", filter.covariance);
  for_each_field(filter.pending, visit);
  visit("acceleration_world_mps2", filter.acceleration_world_mps2);
  visit("angular_velocity_body_radps", filter.angular_velocity_body_radps);
}

void for_each_field(IsFieldsOf<Candidate> auto& candidate, const auto& visit) {
  for_each_field(candidate.filter, visit);
  visit("score", candidate.score);
  visit("rejected_in_row", candidate.rejected_in_row);
  visit("explained_in_row", candidate.explained_in_row);
}

void for_each_field(IsFieldsOf<Rival> auto& rival, const auto& visit) {
  for_each_field(rival.filter, visit);
  visit("alive", rival.alive);
  visit("began_ns", rival.began_ns);
  visit("last_fix_ns", rival.last_fix_ns);
  visit("fixes", rival.fixes);
  visit("misses_in_row", rival.misses_in_row);
  visit("fixes_of_best", rival.fixes_of_best);
  visit("has_turned", rival.has_turned);
  visit("headings", rival.headings);
  visit("rejected_world_m", rival.rejected_world_m);
  visit("rejected_ns", rival.rejected_ns);
}

void for_each_field(IsFieldsOf<Former> auto& former, const auto& visit) {
  for_each_field(former.filter, visit);
  visit("alive", former.alive);
  visit("is_anchor", former.is_anchor);
  visit("left_ns", former.left_ns);
  visit("left_for_ns", former.left_for_ns);
  visit("model", former.model);
  visit("fixes_in_row", former.fixes_in_row);
}

void for_each_field(IsFieldsOf<MeasurementNoise::Bin> auto& bin, const auto& visit) {
  visit("horizontal_m2", bin.horizontal_m2.variance);
  visit("horizontal_samples", bin.horizontal_m2.samples);
  visit("horizontal_motion_m2", bin.horizontal_m2.motion_variance);
  visit("vertical_m2", bin.vertical_m2.variance);
  visit("vertical_samples", bin.vertical_m2.samples);
  visit("vertical_motion_m2", bin.vertical_m2.motion_variance);
}

void for_each_field(IsFieldsOf<Trend> auto& trend, const auto& visit) {
  visit("samples", trend.samples);
  visit("latest_ns", trend.latest_ns);
  visit("weight", trend.weight);
  visit("time_mean_s", trend.time_mean_s);
  visit("time_squares_s2", trend.time_squares_s2);
  visit("mean", trend.mean);
  visit("products", trend.products);
}

void for_each_field(IsFieldsOf<DefaultPosition::Coordinates> auto& coordinates, const auto& visit) {
  visit("position_world_m", coordinates.position_world_m);
}

void for_each_field(IsFieldsOf<Belief> auto& belief, const auto& visit) {
  visit("phase", belief.phase);
  visit("time_ns", belief.time_ns);
  visit("rate_body_radps", belief.rate_body_radps);
  visit("force_body_mps2", belief.force_body_mps2);
  visit("mean_force_body_mps2", belief.mean_force_body_mps2);
  visit("in_imu_gap", belief.in_imu_gap);
  visit("restart_pending", belief.restart_pending);

  visit("shocks.intervals", belief.shocks.intervals);
  visit("shocks.open_s", belief.shocks.open_s);
  visit("shocks.roughness_mps2", belief.shocks.roughness_mps2);
  visit("shocks.open_impulse_body_mps", belief.shocks.open_impulse_body_mps);
  visit("shocks.force_body_mps2.before", belief.shocks.force_body_mps2[0]);
  visit("shocks.force_body_mps2.last", belief.shocks.force_body_mps2[1]);

  visit("rest.window_began_ns", belief.rest.window_began_ns);
  visit("rest.samples", belief.rest.samples);
  visit("rest.gyro_mean", belief.rest.gyro_mean);
  visit("rest.gyro_squares", belief.rest.gyro_squares);
  visit("rest.accel_mean", belief.rest.accel_mean);
  visit("rest.accel_squares", belief.rest.accel_squares);
  visit("rest.still_windows", belief.rest.still_windows);
  visit("rest.still_since_ns", belief.rest.still_since_ns);
  visit("rest.still_gyro_mean", belief.rest.still_gyro_mean);
  visit("rest.still_accel_mean", belief.rest.still_accel_mean);
  visit("rest.fixes", belief.rest.fixes);
  visit("rest.headings", belief.rest.headings);
  visit("rest.first_heading_rad", belief.rest.first_heading_rad);

  visit("noise.any_quality", belief.noise.any_quality);
  visit("noise.bins", belief.noise.bins);
  visit("noise.heading_rad2", belief.noise.heading_rad2.variance);
  visit("noise.heading_samples", belief.noise.heading_rad2.samples);
  visit("noise.heading_motion_rad2", belief.noise.heading_rad2.motion_variance);

  visit("repetition.has_fix", belief.repetition.has_fix);
  visit("repetition.frozen", belief.repetition.frozen);
  visit("repetition.repeats", belief.repetition.repeats);
  visit("repetition.coordinates_world_m", belief.repetition.coordinates_world_m);
  visit("repetition.began_ns", belief.repetition.began_ns);
  visit("repetition.moved_world_m", belief.repetition.moved_world_m);
  visit("repetition.velocity_world_mps", belief.repetition.velocity_world_mps);

  visit("best", belief.best);
  visit("candidate_count", belief.candidate_count);
  visit("candidates", belief.candidates);
  visit("rival", belief.rival);
  visit("former", belief.former);
  visit("wrong_tracks.longest_s", belief.wrong_tracks.longest_s);
  visit("wrong_tracks.seen_ns", belief.wrong_tracks.seen_ns);
  visit("default_position.recent", belief.default_position.recent);
  visit("default_position.fixes", belief.default_position.fixes);
  visit("default_position.is_known", belief.default_position.is_known);
  visit("default_position.default_world_m", belief.default_position.default_world_m);
  visit("default_position.seen_ns", belief.default_position.seen_ns);
  visit("default_position.in_row", belief.default_position.in_row);
  visit("correlation.last", belief.correlation.last);
  visit("correlation.product", belief.correlation.product);
  visit("correlation.square", belief.correlation.square);
  visit("explanations.best", belief.explanations.best);
  visit("explanations.rival", belief.explanations.rival);
  visit("explanations.gyro", belief.explanations.gyro);
  visit("explanations.accel", belief.explanations.accel);
  visit("explanations.scatter_m2", belief.explanations.scatter_m2);
  visit("explanations.shift_ns", belief.explanations.shift_ns);
  visit("explanations.shift_world_m", belief.explanations.shift_world_m);
  visit("explanations.shift_world_mps", belief.explanations.shift_world_mps);
  visit("explanations.shift_variance_m2", belief.explanations.shift_variance_m2);
  visit("explanations.shift_covariance", belief.explanations.shift_covariance);
  visit("explanations.shift_rate_variance", belief.explanations.shift_rate_variance);
  visit("suspicious_until_ns", belief.suspicious_until_ns);
  visit("imu_doubted_until_ns", belief.imu_doubted_until_ns);
  visit("imu_doubted_ns", belief.imu_doubted_ns);
  visit("imu_doubts", belief.imu_doubts);
  visit("trusted_gyro_bias_body_radps", belief.trusted_gyro_bias_body_radps);
  visit("trusted_accel_bias_body_mps2", belief.trusted_accel_bias_body_mps2);
  visit("last_fix_ns", belief.last_fix_ns);
  visit("fixes_since_start", belief.fixes_since_start);
  visit("fixes_rejected_in_row", belief.fixes_rejected_in_row);
  visit("usual_step_s", belief.usual_step_s);
  visit("last_heading_ns", belief.last_heading_ns);
  visit("last_heading_rad", belief.last_heading_rad);
  visit("heading_is_current", belief.heading_is_current);
  visit("heading_rejected_since_ns", belief.heading_rejected_since_ns);
  visit("heading_rejected_ns", belief.heading_rejected_ns);
  visit("headings_rejected_in_row", belief.headings_rejected_in_row);
  visit("heading_rejected_by_rad", belief.heading_rejected_by_rad);
  visit("heading_seen_ns", belief.heading_seen_ns);
  visit("heading_interval_s", belief.heading_interval_s);
  visit("quality_percent", belief.quality_percent);
  visit("converging_until_ns", belief.converging_until_ns);
  visit("slowed_ns", belief.slowed_ns);
  visit("trust", belief.trust);
}

/// The counters are listed elsewhere (samples/estimator_counters.hpp).
void for_each_field(IsFieldsOf<Snapshot> auto& snapshot, const auto& visit) {
  for_each_field(snapshot.history.base, visit);
  visit("imu", snapshot.history.imu);
  visit("fixes", snapshot.history.fixes);
  visit("headings", snapshot.history.headings);
  visit("stamps_are_ahead", snapshot.history.stamps_are_ahead);
  visit("admission.backward_in_row", snapshot.admission.backward_in_row);
  visit("admission.announced_ns", snapshot.admission.announced_ns);
  visit("last_used_received_ns", snapshot.last_used_received_ns);
  visit("last_delay_s", snapshot.last_delay_s);
  visit("last_position_world_m", snapshot.last_position_world_m);
}

/// The first field whose value no engine can have although its type allows it.
[[nodiscard]] std::optional<FieldFault> find_fault(const Snapshot& snapshot);

}  // namespace sonopose::estimation::kalman
