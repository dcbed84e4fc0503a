#include <sonopose/estimation/prediction.hpp>
#include <sonopose/geometry/rotation.hpp>

namespace sonopose::estimation {

TimeNs prediction_period_ns(const settings::OutputSettings& settings) {
  return settings.rate_hz > 0 ? to_ns(1.0 / settings.rate_hz) : 0;
}

FusedPose predicted(const FusedPose& at_sample, TimeNs ahead_ns) {
  constexpr std::uint32_t without_acceleration = status_stale | status_initialising | status_rotating_fast;
  const double dt_s = static_cast<double>(ahead_ns) * 1e-9;
  const bool accelerates = (at_sample.status & without_acceleration) == 0U;
  const Vector3d acceleration_world_mps2 =
      accelerates ? at_sample.acceleration_world_mps2 : Vector3d(Vector3d::Zero());

  FusedPose pose = at_sample;
  pose.time_ns += ahead_ns;
  pose.status |= status_predicted;
  pose.since_valid_fix_s += dt_s;
  pose.position_world_m += dt_s * at_sample.velocity_world_mps + 0.5 * dt_s * dt_s * acceleration_world_mps2;
  pose.velocity_world_mps += dt_s * acceleration_world_mps2;
  pose.q_body_to_world = (at_sample.q_body_to_world *
                          geometry::rotation_by(Vector3d(dt_s * at_sample.angular_velocity_body_radps)))
                             .normalized();
  // The errors of position and velocity are taken as independent.
  for (int axis = 0; axis < 3; ++axis) {
    if (!pose.pose_covariance.is_known(axis) || !pose.velocity_covariance.is_known(axis)) continue;
    const double drift_m2 = dt_s * dt_s * pose.velocity_covariance.at(axis, axis);
    pose.pose_covariance.set(axis, axis, pose.pose_covariance.at(axis, axis) + drift_m2);
  }
  return pose;
}

}  // namespace sonopose::estimation
