// What the engine shows of its state.

#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/estimation/documented/motion.hpp>

#include <algorithm>
#include <limits>

namespace sonopose::estimation::documented {

FusedPose Engine::pose_at(const ImuSample& imu) const {
  const Kinematics& body = state_.body;
  FusedPose pose;
  pose.address = imu.address;
  pose.sequence = imu.sequence;
  pose.time_ns = body.time_ns;
  pose.position_world_m = body.position_world_m;
  pose.q_body_to_world = state_.filter.orientation();
  // While the start waits for stillness the position is held: a velocity beside it would be a contradiction.
  pose.velocity_world_mps = state_.startup.waiting ? Vector3d::Zero() : body.velocity_world_mps;
  pose.angular_velocity_body_radps = body.angular_velocity_body_radps;
  pose.acceleration_world_mps2 = body.acceleration_world_mps2;
  pose.gyro_bias_body_radps = state_.startup.gyro_offset_body_radps + state_.filter.gyro_bias_body_radps();
  pose.pose_covariance = uncertainty::pose_covariance(state_.uncertainty);
  pose.velocity_covariance = uncertainty::velocity_covariance(state_.uncertainty);
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

std::uint32_t Engine::status() const {
  const auto bit = [](bool holds, PoseStatus status) { return holds ? std::uint32_t{status} : 0U; };
  const bool no_position = state_.outage.last_valid_fix_ns == 0;
  const bool far_off = trust::is_far(settings_.trust, state_.drift.offset_world_m.norm());
  return bit(no_position || state_.startup.waiting, status_initialising) |
         bit(!state_.startup.waiting && !state_.startup.calibrated, status_uncalibrated) |
         bit(state_.outage.stale, status_stale) | bit(state_.trust.forced || far_off, status_converging) |
         bit(!heading::is_valid(settings_.heading, state_.heading, state_.body.time_ns),
             status_heading_unknown) |
         bit(state_.frozen.frozen, status_frozen_track) | bit(state_.in_imu_gap, status_imu_gap) |
         bit(state_.trust.trust < 1.0, status_low_trust) |
         bit(motion::is_gated(settings_.motion, state_.body), status_rotating_fast);
}

}  // namespace sonopose::estimation::documented
