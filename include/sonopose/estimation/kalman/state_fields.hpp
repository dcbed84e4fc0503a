#pragma once
/// \file
/// Every field of a snapshot by name, to save, restore and hash it. The order is the order of the hash.

#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/samples/field_fault.hpp>

#include <algorithm>
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
  visit("position_world_m", fix.position_world_m);
  visit("quality_percent", fix.quality_percent);
  visit("has_covariance", fix.has_covariance);
  visit("covariance_world_m2", fix.covariance_world_m2);
}

void for_each_field(IsFieldsOf<HeadingMeasurement> auto& heading, const auto& visit) {
  visit("time_ns", heading.time_ns);
  visit("heading_world_rad", heading.heading_world_rad);
}

void for_each_field(IsFieldsOf<Transition> auto& transition, const auto& visit) {
  visit("duration_s", transition.duration_s);
  visit("position_velocity_s", transition.position_velocity_s);
  visit("rotation_start", transition.rotation_start);
  visit("impulse_mps", transition.impulse_mps);
  visit("impulse_sum_m", transition.impulse_sum_m);
  visit("rotation_sum_s", transition.rotation_sum_s);
  visit("rotation_double_sum_s2", transition.rotation_double_sum_s2);
  visit("velocity_gyro_bias", transition.velocity_gyro_bias);
  visit("position_gyro_bias", transition.position_gyro_bias);
}

void for_each_field(IsFieldsOf<Filter> auto& filter, const auto& visit) {
  visit("position_world_m", filter.position_world_m);
  visit("velocity_world_mps", filter.velocity_world_mps);
  visit("q_body_to_world", filter.q_body_to_world);
  visit("gyro_bias_body_radps", filter.gyro_bias_body_radps);
  visit("accel_bias_body_mps2", filter.accel_bias_body_mps2);
  visit("lever_arm_body_m", filter.lever_arm_body_m);
  visit("covariance", filter.covariance);
  for_each_field(filter.pending, visit);
  visit("acceleration_world_mps2", filter.acceleration_world_mps2);
  visit("angular_velocity_body_radps", filter.angular_velocity_body_radps);
}

void for_each_field(IsFieldsOf<Candidate> auto& candidate, const auto& visit) {
  for_each_field(candidate.filter, visit);
  visit("score", candidate.score);
  visit("rejected_in_row", candidate.rejected_in_row);
}

void for_each_field(IsFieldsOf<Rival> auto& rival, const auto& visit) {
  for_each_field(rival.filter, visit);
  visit("alive", rival.alive);
  visit("began_ns", rival.began_ns);
  visit("last_fix_ns", rival.last_fix_ns);
  visit("fixes", rival.fixes);
  visit("misses_in_row", rival.misses_in_row);
}

void for_each_field(IsFieldsOf<Former> auto& former, const auto& visit) {
  for_each_field(former.filter, visit);
  visit("alive", former.alive);
  visit("left_ns", former.left_ns);
  visit("fixes_in_row", former.fixes_in_row);
}

void for_each_field(IsFieldsOf<MeasurementNoise::Bin> auto& bin, const auto& visit) {
  visit("horizontal_m2", bin.horizontal_m2.variance);
  visit("horizontal_samples", bin.horizontal_m2.samples);
  visit("vertical_m2", bin.vertical_m2.variance);
  visit("vertical_samples", bin.vertical_m2.samples);
}

void for_each_field(IsFieldsOf<Belief> auto& belief, const auto& visit) {
  visit("phase", belief.phase);
  visit("time_ns", belief.time_ns);
  visit("rate_body_radps", belief.rate_body_radps);
  visit("force_body_mps2", belief.force_body_mps2);
  visit("mean_force_body_mps2", belief.mean_force_body_mps2);
  visit("in_imu_gap", belief.in_imu_gap);
  visit("restart_pending", belief.restart_pending);

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
  visit("rest.time_mean_s", belief.rest.time_mean_s);
  visit("rest.time_squares_s2", belief.rest.time_squares_s2);
  visit("rest.position_mean_m", belief.rest.position_mean_m);
  visit("rest.products_m_s", belief.rest.products_m_s);

  visit("noise.bins", belief.noise.bins);
  visit("noise.heading_rad2", belief.noise.heading_rad2.variance);
  visit("noise.heading_samples", belief.noise.heading_rad2.samples);

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
  visit("last_fix_ns", belief.last_fix_ns);
  visit("last_heading_ns", belief.last_heading_ns);
  visit("last_heading_rad", belief.last_heading_rad);
  visit("heading_rejected_since_ns", belief.heading_rejected_since_ns);
  visit("heading_rejected_ns", belief.heading_rejected_ns);
  visit("headings_rejected_in_row", belief.headings_rejected_in_row);
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
  visit("admission.backward_in_row", snapshot.admission.backward_in_row);
  visit("admission.announced_ns", snapshot.admission.announced_ns);
  visit("last_used_received_ns", snapshot.last_used_received_ns);
  visit("last_position_world_m", snapshot.last_position_world_m);
}

/// The first field whose value no engine can have although its type allows it.
inline std::optional<FieldFault> find_fault(const Snapshot& snapshot) {
  const Belief& base = snapshot.history.base;
  if (base.candidate_count > start_count) {
    return FieldFault{"candidate_count", "is more than the number of starts"};
  }
  if (base.phase != Phase::waiting && base.candidate_count == 0) {
    return FieldFault{"candidate_count", "is 0 although the estimate has begun"};
  }
  if (!(base.trust >= 0.0 && base.trust <= 1.0)) return FieldFault{"trust", "is not between 0 and 1"};
  if (base.best >= std::max(base.candidate_count, 1)) {
    return FieldFault{"best", "is not the index of a candidate"};
  }
  if (base.phase == Phase::tracking && base.candidate_count != model_count) {
    return FieldFault{"candidate_count", "is not the number of models"};
  }
  TimeNs before_ns = base.time_ns;
  for (const ImuMeasurement& imu : snapshot.history.imu) {
    if (imu.time_ns < before_ns) return FieldFault{"imu", "has times that go backward"};
    before_ns = imu.time_ns;
  }
  for (int i = 0; i < base.candidate_count; ++i) {
    const auto& filter = base.candidates[static_cast<std::size_t>(i)].filter;
    if (!(filter.covariance.diagonal().minCoeff() >= 0.0)) {
      return FieldFault{"candidates", "have a negative variance"};
    }
  }
  return std::nullopt;
}

}  // namespace sonopose::estimation::kalman
