#include "autopilot/ardupilot.hpp"

#include <sonopose/ros2/messages/messages.hpp>

namespace sonopose::autopilot {

NotSent ardupilot_not_sent(const ExternalOdometry& odometry, bool with_velocity) {
  if (!odometry.q_body_to_frame) return NotSent::yaw_unknown;
  return with_velocity && !odometry.velocity_body_mps.allFinite() ? NotSent::no_velocity : NotSent::none;
}

ros2::TransformStamped ardupilot_transform(const ExternalOdometry& odometry, TimeNs measured_ns,
                                           const ArduPilotFrames& frames) {
  // Half a turn about x makes x, −y, −z of both frames: up of down, and left of right.
  const Vector3d& p = odometry.position_frame_m;
  const Quaterniond q = odometry.q_body_to_frame.value_or(Quaterniond::Identity());
  return ros2::transform({{p.x(), -p.y(), -p.z()}, {q.w(), q.x(), -q.y(), -q.z()}}, measured_ns,
                         frames.parent, frames.child);
}

}  // namespace sonopose::autopilot
