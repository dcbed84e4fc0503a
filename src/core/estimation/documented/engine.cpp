// The steps of the document in their order; numbers are its items. Each step is a stage in a file of the same
// name; fixes.cpp has the steps of a fix.

#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/estimation/aiding/planar.hpp>
#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/estimation/documented/motion.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/preset.hpp>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

namespace sonopose::estimation::documented {
namespace {

void record_path(const HeadingSettings& settings, State& state) {
  Kinematics& body = state.body;
  const double yaw_rad =
      heading::yaw_by_pair(settings, state.filter.orientation()) - body.yaw_corrections_rad;
  body.history.push({body.time_ns, body.displacement_world_m, geometry::wrap_angle(yaw_rad)});
}

}  // namespace

Engine::Engine(const settings::Settings& settings)
    : settings_(resolved(settings)), calibration_(settings.calibration) {}

void Engine::configure(const settings::Settings& settings) noexcept {
  static_assert(std::is_trivially_copyable_v<settings::Settings>);  // cannot throw or allocate
  settings_ = resolved(settings);
  const calibration::Calibration before = calibration_;
  calibration_ = calibration::Calibration(settings.calibration);
  if (!(calibration_ == before)) convert_gyro_offset(before);
}

/// Re-expresses the gyro bias, learned under the old calibration, in the new one.
void Engine::convert_gyro_offset(const calibration::Calibration& before) {
  const Vector3d start_radps = state_.startup.gyro_offset_body_radps;
  const Vector3d whole_radps = start_radps + state_.filter.gyro_bias_body_radps();
  const Vector3d new_start_radps = calibration_.rate_from(before, start_radps);
  const Vector3d new_whole_radps = calibration_.rate_from(before, whole_radps);
  if (!new_start_radps.allFinite() || !new_whole_radps.allFinite()) return;
  state_.startup.gyro_offset_body_radps = new_start_radps;
  state_.filter.set_gyro_bias(new_whole_radps - new_start_radps);
}

void Engine::reset() noexcept {
  state_ = State{};
  set_yaw_.reset();
  path_is_behind_ = false;
  ++reset_counter_;
}

void Engine::restore(const Snapshot& snapshot) noexcept {
  state_ = snapshot.state;
  counters_ = snapshot.counters;
  reset_counter_ = snapshot.reset_counter;
  set_yaw_.reset();
  path_is_behind_ = false;
}

Engine::Snapshot Engine::snapshot() const {
  Snapshot snapshot{state_, counters_, reset_counter_};
  if (path_is_behind_) record_path(settings_.heading, snapshot.state);
  return snapshot;
}

void Engine::finish_pending_work() noexcept {
  if (std::exchange(path_is_behind_, false)) record_path(settings_.heading, state_);
}

// One IMU sample

std::optional<FusedPose> Engine::predict(const ImuSample& raw) noexcept {
  finish_pending_work();
  const ImuSample imu = calibration_.corrected(raw);
  if (!admit(imu)) return std::nullopt;
  if (!state_.body.started()) start(imu);
  const double dt_s = seconds_between(state_.body.time_ns, imu.sensor_time_ns);
  state_.in_imu_gap = outage::is_imu_gap(settings_.outage, dt_s);
  if (state_.in_imu_gap) startup::begin_window(state_.startup, imu.sensor_time_ns);
  calibrate_at_rest(imu);
  state_.body.time_ns = imu.sensor_time_ns;
  if (state_.in_imu_gap) {
    predict_over_gap(imu, dt_s);
  } else {
    integrate(imu, dt_s);
  }
  path_is_behind_ = true;
  return pose_at(imu);
}

bool Engine::admit(const ImuSample& imu) {
  const TimeNs now_ns = state_.body.time_ns;
  if (!aiding::admission::admits(settings_.admission, now_ns, imu) ||
      aiding::admission::is_time_jump(state_.admission, now_ns, imu)) {
    ++counters_.samples_invalid;
    if (aiding::admission::needs_time_reset(state_.admission, now_ns, imu)) reset();
    return false;
  }
  state_.admission.backward_in_row = 0;
  ++counters_.imu_samples;
  return true;
}

void Engine::start(const ImuSample& imu) {
  state_.body.time_ns = imu.sensor_time_ns;
  const auto field = attitude::field_use(settings_.attitude.selection);
  state_.filter.reset(attitude::first_orientation(field.measurement_of(imu, 0.0)));
}

void Engine::calibrate_at_rest(const ImuSample& imu) {
  const bool at_start = state_.startup.waiting;
  if (startup::update(settings_.startup, state_.startup, imu) != startup::Progress::calibrated) return;
  // The mean of a second at rest is more accurate than the filter's vertical at that time.
  const double yaw_rad = geometry::yaw_of(state_.filter.orientation());
  state_.filter.reset(geometry::level_with(state_.startup.accel_mean, yaw_rad));
  state_.heading.rate_offset_radps = 0.0;  // part of the gyroscope offset, which is now known
  if (!at_start) return;
  state_.body.correct_velocity(-state_.body.velocity_world_mps);
  state_.uncertainty.velocity_std_mps = 0.0;
  state_.velocity.settle();
  if (state_.outage.init_phase == InitPhase::no_velocity) state_.outage.init_phase = InitPhase::tracking;
}

void Engine::integrate(const ImuSample& imu, double dt_s) {
  Kinematics& body = state_.body;
  integrate_attitude(imu, dt_s);  // 29, 30
  const double yaw_share =
      heading::correct_from_pair(settings_.heading, state_.heading, body, state_.filter, dt_s);  // 34
  const Vector3d velocity_before_world_mps = body.velocity_world_mps;
  integrate_velocity(imu, dt_s);                                  // 10, 11, 23–25, 35–37
  drift::apply_decay(settings_.drift, state_.drift, body, dt_s);  // 2, 9
  body.displacement_world_m += dt_s * (0.5 * (velocity_before_world_mps + body.velocity_world_mps) -
                                       body.velocity_corrections_world_mps);

  uncertainty::grow(settings_.uncertainty, state_.uncertainty, dt_s);
  uncertainty::correct_yaw(settings_.uncertainty, state_.uncertainty, yaw_share);
}

void Engine::integrate_attitude(const ImuSample& imu, double dt_s) {
  const Vector3d rate_body_radps = imu.angular_velocity_body_radps - state_.startup.gyro_offset_body_radps;
  const Vector3d mean_rate_body_radps = 0.5 * (state_.previous_rate_body_radps + rate_body_radps);
  state_.previous_rate_body_radps = rate_body_radps;
  state_.body.angular_velocity_body_radps = rate_body_radps - state_.filter.gyro_bias_body_radps();

  auto measurement = attitude::field_use(settings_.attitude.selection).measurement_of(imu, dt_s);
  measurement.angular_velocity_body_radps = mean_rate_body_radps;
  alignment::add_known_acceleration(settings_.alignment, state_.alignment, imu.sensor_time_ns, measurement);
  state_.filter.update(settings_.attitude, measurement);
}

void Engine::integrate_velocity(const ImuSample& imu, double dt_s) {
  Kinematics& body = state_.body;
  const Vector3d before_world_mps2 = body.acceleration_world_mps2;
  body.acceleration_world_mps2 = world_acceleration(imu);
  const bool no_position = state_.outage.last_valid_fix_ns == 0;
  if (state_.startup.waiting || no_position) return;                    // at rest, or no start of an integral
  if (outage::update(settings_.outage, state_.outage, body.time_ns)) {  // 11
    outage::decay(settings_.outage, body, dt_s);                        // 10
    alignment::clear_known_acceleration(state_.alignment);
    motion::predict_without_imu(body, dt_s);
    return;
  }
  const Vector3d velocity_before_world_mps = body.velocity_world_mps;
  const Vector3d mean_world_mps2 = 0.5 * (before_world_mps2 + body.acceleration_world_mps2);
  motion::integrate(settings_.motion, body, motion::gate(settings_.motion, body, mean_world_mps2),
                    dt_s);  // 25, 35–37
  const Vector3d gained_world_mps = body.velocity_world_mps - velocity_before_world_mps;
  state_.alignment.gained_world_mps += gained_world_mps;
  if (motion::is_gated(settings_.motion, body)) {
    alignment::suspend(state_.alignment, body.time_ns);
  } else if (state_.outage.init_phase == InitPhase::tracking && state_.velocity.settled()) {
    alignment::set_known_acceleration(settings_.alignment, state_.alignment, gained_world_mps, body.time_ns,
                                      dt_s);
  } else {
    alignment::clear_known_acceleration(state_.alignment);
  }
  runaway::damp(settings_.runaway, state_.runaway, body, dt_s);  // 23, 24
}

/// Acceleration a = R(q)·f + g, plus the learned vertical offset.
Vector3d Engine::world_acceleration(const ImuSample& imu) const {
  Vector3d acceleration_world_mps2 = state_.filter.orientation() * imu.specific_force_body_mps2;
  acceleration_world_mps2.z() += state_.alignment.vertical_offset_mps2 - standard_gravity_mps2;
  return acceleration_world_mps2;
}

/// Coasts over a gap, whose motion is unknown. Older fixes have no inertial path to be compared with, and the
/// next fix sets the position.
void Engine::predict_over_gap(const ImuSample& imu, double dt_s) {
  ++counters_.imu_gaps;
  state_.previous_rate_body_radps = imu.angular_velocity_body_radps - state_.startup.gyro_offset_body_radps;
  state_.body.angular_velocity_body_radps =
      state_.previous_rate_body_radps - state_.filter.gyro_bias_body_radps();
  state_.body.acceleration_world_mps2 = world_acceleration(imu);
  outage::decay(settings_.outage, state_.body, dt_s);
  state_.outage.init_phase = InitPhase::no_position;
  state_.body.history.clear();
  frozen::begin_window(state_.frozen, state_.body);
  state_.drift = DriftState{};
  alignment::clear_known_acceleration(state_.alignment);
  uncertainty::grow(settings_.uncertainty, state_.uncertainty, dt_s);
}

// One pair heading

void Engine::correct(const PairHeading& heading) noexcept {
  finish_pending_work();
  const TimeNs measured_ns = aiding::measured_at(settings_.delay, heading);  // 6
  if (!aiding::admission::admits(settings_.admission, state_.body.time_ns, heading, measured_ns)) {
    ++counters_.samples_invalid;
    return;
  }
  if ((heading.flags & heading_flag_set_pose) != 0) {
    set_yaw_ = heading;
    return;
  }
  ++counters_.headings;
  if (state_.frozen.frozen) return;  // computed from the same frozen fixes
  heading::set_target(settings_.heading, state_.heading, state_.body, state_.filter, heading,
                      measured_ns);  // 5
}

void Engine::correct(const TwistSample& /*twist*/) noexcept {
  ++counters_.twists_unused;
}

// The pose

FusedPose Engine::pose_at(const ImuSample& imu) const {
  const Kinematics& body = state_.body;
  FusedPose pose;
  pose.address = imu.address;
  pose.sequence = imu.sequence;
  pose.time_ns = body.time_ns;
  pose.position_world_m = body.position_world_m;
  pose.q_body_to_world = state_.filter.orientation();
  // The position stays while the start waits for stillness; a velocity would contradict it.
  pose.velocity_world_mps = state_.startup.waiting ? Vector3d::Zero() : body.velocity_world_mps;
  pose.angular_velocity_body_radps = body.angular_velocity_body_radps;
  pose.acceleration_world_mps2 = body.acceleration_world_mps2;
  pose.gyro_bias_body_radps = gyro_bias_body_radps();
  const Vector3d share = trust::share_of(settings_.trust, state_.scatter.noise_world_m);
  pose.pose_covariance = uncertainty::pose_covariance(state_.uncertainty, share);
  pose.velocity_covariance = uncertainty::velocity_covariance(state_.uncertainty, share);
  if (aiding::ignores_height(settings_.planar)) {
    const double height_m2 = settings_.planar.height_std_m * settings_.planar.height_std_m;
    pose.pose_covariance.set(2, 2, pose.pose_covariance.at(2, 2) + height_m2);
  }
  pose.trust = state_.trust.trust;
  pose.since_valid_fix_s =
      state_.outage.last_valid_fix_ns == 0
          ? std::numeric_limits<double>::infinity()
          : std::max(0.0, seconds_between(state_.outage.last_valid_fix_ns, body.time_ns));
  pose.reset_counter = reset_counter_;
  pose.status = status();
  pose.imu_sensor_time_ns = imu.sensor_time_ns;
  pose.imu_bridge_time_ns = imu.bridge_time_ns;
  return pose;
}

Vector3d Engine::gyro_bias_body_radps() const {
  return state_.startup.gyro_offset_body_radps + state_.filter.gyro_bias_body_radps();
}

/// Returns the gyro bias, the only estimate; its standard deviation is unknown.
Estimate Engine::estimate() const {
  Estimate estimate;
  estimate.time_ns = state_.body.time_ns;
  if (state_.startup.calibrated) {
    estimate.gyro_bias_body_radps = {.value = gyro_bias_body_radps(), .std = Vector3d::Constant(-1.0)};
  }
  return estimate;
}

std::uint32_t Engine::status() const {
  const auto bit = [](bool applies, PoseStatus status) { return applies ? std::uint32_t{status} : 0U; };
  const bool no_position = state_.outage.last_valid_fix_ns == 0;
  const bool far_off = trust::is_far(settings_.trust, state_.drift.offset_world_m.norm());
  return bit(no_position || state_.startup.waiting, status_initialising) |
         bit(!state_.startup.waiting && !state_.startup.calibrated, status_uncalibrated) |
         bit(state_.outage.stale, status_stale) | bit(state_.trust.forced || far_off, status_converging) |
         bit(!heading::is_valid(settings_.heading, state_.heading, state_.body.time_ns),
             status_heading_unknown) |
         bit(state_.default_position.is_active(state_.body.time_ns), status_fixes_inconsistent) |
         bit(state_.frozen.frozen, status_frozen_track) | bit(state_.in_imu_gap, status_imu_gap) |
         bit(state_.trust.trust < 1.0, status_low_trust) |
         bit(motion::is_gated(settings_.motion, state_.body), status_rotating_fast);
}

}  // namespace sonopose::estimation::documented
