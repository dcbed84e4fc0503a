#include <sonopose/estimation/aiding/planar.hpp>
#include <sonopose/geometry/rotation.hpp>

namespace sonopose::estimation::aiding {

Vector3d position_in_plane(const settings::PlanarSettings& settings, const Vector3d& position_world_m,
                           const Vector3d& point_body_m) {
  if (!ignores_height(settings)) return position_world_m;
  return {position_world_m.x(), position_world_m.y(), settings.height_m + point_body_m.z()};
}

void flatten(const settings::PlanarSettings& settings, FusedPose& pose) {
  if (!settings.planar || !settings.output_flat) return;
  pose.position_world_m.z() = 0.0;
  pose.velocity_world_mps.z() = 0.0;
  pose.acceleration_world_mps2.z() = 0.0;
  // A prediction from this pose is flat too.
  pose.angular_velocity_body_radps = {0.0, 0.0,
                                      (pose.q_body_to_world * pose.angular_velocity_body_radps).z()};
  pose.q_body_to_world = geometry::rotation_about_z(geometry::yaw_of(pose.q_body_to_world));
}

}  // namespace sonopose::estimation::aiding
