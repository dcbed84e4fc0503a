#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/estimation/documented/motion.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/preset.hpp>

#include <algorithm>
#include <limits>
#include <type_traits>

namespace sonopose::estimation::documented {
Engine::Engine(const settings::Settings& settings)
    : settings_(resolved(settings)), calibration_(settings.calibration) {}

void Engine::configure(const settings::Settings& settings) noexcept {
  static_assert(std::is_trivially_copyable_v<settings::Settings>);  // so that nothing can throw or allocate
  settings_ = resolved(settings);
  const calibration::Calibration before = calibration_;
  calibration_ = calibration::Calibration(settings.calibration);
  if (!(calibration_ == before)) translate_offset(before);
}

/// What rest has told of the gyroscope was told in the terms of the calibration before.
void Engine::translate_offset(const calibration::Calibration& before) {
  const Vector3d start_radps = state_.startup.gyro_offset_body_radps;
  const Vector3d whole_radps = start_radps + state_.filter.gyro_bias_body_radps();
  const Vector3d new_start_radps = calibration_.rate_from(before, start_radps);
  const Vector3d new_whole_radps = calibration_.rate_from(before, whole_radps);
  if (!new_start_radps.allFinite() || !new_whole_radps.allFinite()) return;
  state_.startup.gyro_offset_body_radps = new_start_radps;
  state_.filter.set_gyro_bias(new_whole_radps - new_start_radps);
}

std::optional<FusedPose> Engine::on(const ImuSample& raw) noexcept {
  const ImuSample imu = calibration_.corrected(raw);
  if (!admission::admits(settings_.admission, state_.body.time_ns, imu) ||
      admission::is_sudden(state_.admission, state_.body.time_ns, imu)) {
    ++counters_.samples_invalid;
    if (admission::time_was_wrong(state_.admission, state_.body.time_ns, imu)) reset();
    return std::nullopt;
  }
  state_.admission.backward_in_row = 0;
  ++counters_.imu_samples;
  if (!state_.body.started()) start(imu);
  const double dt_s = seconds_between(state_.body.time_ns, imu.sensor_time_ns);
  state_.in_imu_gap = outage::is_imu_gap(settings_.outage, dt_s);
  if (state_.in_imu_gap) startup::begin_window(state_.startup, imu.sensor_time_ns);
  calibrate(imu);
  state_.body.time_ns = imu.sensor_time_ns;
  if (state_.in_imu_gap) {
    rest_over_gap(imu, dt_s);
  } else {
    predict(imu, dt_s);
  }
  remember_path();
  return pose_at(imu);
}

void Engine::reset() noexcept {
  state_ = State{};
  ++reset_counter_;
}

void Engine::restore(const Snapshot& snapshot) noexcept {
  state_ = snapshot.state;
  counters_ = snapshot.counters;
  reset_counter_ = snapshot.reset_counter;
}

void Engine::start(const ImuSample& imu) {
  state_.body.time_ns = imu.sensor_time_ns;
  const auto field = attitude::field_use(settings_.attitude.selection);
  state_.filter.reset(attitude::first_orientation(field.measurement_of(imu, 0.0)));
}

void Engine::calibrate(const ImuSample& imu) {
  const bool at_start = state_.startup.waiting;
  if (startup::watch(settings_.startup, state_.startup, imu) != startup::Progress::calibrated) return;
  // The mean of a second at rest is a better plumb line than the filter has found by then.
  const double yaw_rad = geometry::yaw_of(state_.filter.orientation());
  state_.filter.reset(geometry::level_with(state_.startup.accel_mean, yaw_rad));
  state_.heading.rate_offset_radps = 0.0;  // it was a part of the offset that is known now
  if (!at_start) return;
  state_.body.correct_velocity(-state_.body.velocity_world_mps);
  state_.uncertainty.velocity_std_mps = 0.0;
  state_.velocity.settle();
  if (state_.outage.track == InitPhase::position) state_.outage.track = InitPhase::held;
}

void Engine::predict(const ImuSample& imu, double dt_s) {
  Kinematics& body = state_.body;
  const double pulled = predict_attitude(imu, dt_s);
  const Vector3d velocity_before_world_mps = body.velocity_world_mps;
  predict_velocity(imu, dt_s);
  drift::apply_decay(settings_.drift, state_.drift, body, dt_s);  // 2, 9
  body.displacement_world_m += dt_s * (0.5 * (velocity_before_world_mps + body.velocity_world_mps) -
                                       body.velocity_corrections_world_mps);

  uncertainty::grow(settings_.uncertainty, state_.uncertainty, dt_s);
  uncertainty::pull_yaw(settings_.uncertainty, state_.uncertainty, pulled);
}

/// Returns the share of the yaw error that a paired heading took away.
double Engine::predict_attitude(const ImuSample& imu, double dt_s) {
  Kinematics& body = state_.body;
  const Vector3d rate_body_radps = imu.angular_velocity_body_radps - state_.startup.gyro_offset_body_radps;
  const Vector3d mean_rate_body_radps = 0.5 * (state_.previous_rate_body_radps + rate_body_radps);
  state_.previous_rate_body_radps = rate_body_radps;
  body.angular_velocity_body_radps = rate_body_radps - state_.filter.gyro_bias_body_radps();

  auto measurement = attitude::field_use(settings_.attitude.selection).measurement_of(imu, dt_s);
  measurement.angular_velocity_body_radps = mean_rate_body_radps;
  alignment::aid(settings_.alignment, state_.alignment, imu.sensor_time_ns, measurement);
  state_.filter.update(settings_.attitude, measurement);                                            // 29, 30
  return heading::correct_from_pair(settings_.heading, state_.heading, body, state_.filter, dt_s);  // 34
}

void Engine::predict_velocity(const ImuSample& imu, double dt_s) {
  Kinematics& body = state_.body;
  const Vector3d before_world_mps2 = body.acceleration_world_mps2;
  body.acceleration_world_mps2 = world_acceleration(imu);
  const bool no_position = state_.outage.last_valid_fix_ns == 0;
  if (state_.startup.waiting || no_position) return;  // at rest, or nothing to start an integral from
  if (outage::watch(settings_.outage, state_.outage, body.time_ns)) {  // 11
    outage::decay(settings_.outage, body, dt_s);                       // 10
    alignment::clear_known_acceleration(state_.alignment);
    motion::coast(body, dt_s);
    return;
  }
  const Vector3d velocity_before_world_mps = body.velocity_world_mps;
  const Vector3d mean_world_mps2 = 0.5 * (before_world_mps2 + body.acceleration_world_mps2);
  motion::integrate(settings_.motion, body, motion::gate(settings_.motion, body, mean_world_mps2),
                    dt_s);  // 25, 35–37
  const Vector3d gained_world_mps = body.velocity_world_mps - velocity_before_world_mps;
  state_.alignment.gained_world_mps += gained_world_mps;
  if (state_.outage.track == InitPhase::held && state_.velocity.settled()) {
    alignment::set_known_acceleration(settings_.alignment, state_.alignment, gained_world_mps, body.time_ns,
                                      dt_s);
  } else {
    alignment::clear_known_acceleration(state_.alignment);
  }
  runaway::damp(settings_.runaway, state_.runaway, body, dt_s);  // 23, 24
}

/// a = R(q)·f + g, and what alignment has learned of the vertical.
Vector3d Engine::world_acceleration(const ImuSample& imu) const {
  Vector3d acceleration_world_mps2 = state_.filter.orientation() * imu.specific_force_body_mps2;
  acceleration_world_mps2.z() += state_.alignment.vertical_offset_mps2 - standard_gravity_mps2;
  return acceleration_world_mps2;
}

void Engine::rest_over_gap(const ImuSample& imu, double dt_s) {
  // Nothing is known of the motion meanwhile: no path to compare old fixes with, and the track is let go.
  ++counters_.imu_gaps;
  state_.previous_rate_body_radps = imu.angular_velocity_body_radps - state_.startup.gyro_offset_body_radps;
  state_.body.angular_velocity_body_radps =
      state_.previous_rate_body_radps - state_.filter.gyro_bias_body_radps();
  state_.body.acceleration_world_mps2 = world_acceleration(imu);
  outage::decay(settings_.outage, state_.body, dt_s);
  state_.outage.track = InitPhase::none;
  state_.body.history.clear();
  frozen::begin_window(state_.frozen, state_.body);
  state_.drift = DriftState{};
  alignment::clear_known_acceleration(state_.alignment);
  uncertainty::grow(settings_.uncertainty, state_.uncertainty, dt_s);
}

void Engine::remember_path() {
  Kinematics& body = state_.body;
  const double yaw_rad = geometry::yaw_of(state_.filter.orientation()) - body.yaw_corrections_rad;
  body.history.push({body.time_ns, body.displacement_world_m, geometry::wrap_angle(yaw_rad)});
}

}  // namespace sonopose::estimation::documented
