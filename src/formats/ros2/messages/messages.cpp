#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <algorithm>

namespace sonopose::ros2 {
namespace {

Vector3 vector(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Point point(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Quaternion quaternion(const Quaterniond& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

/// Copies a row-major matrix to a row-major array.
template <class Covariance, std::size_t size>
void copy(const Covariance& from, double (&to)[size]) {  // NOLINT(modernize-avoid-c-arrays): the IDL's
  static_assert(Covariance::SizeAtCompileTime == size);
  std::copy_n(from.data(), size, std::begin(to));
}

}  // namespace

Header header_of(TimeNs stamp_ns, const std::string& frame_id) {
  return {to_ros(stamp_ns), borrow_string(frame_id)};
}

Imu raw_imu(const ImuSample& sample, TimeNs stamp_ns, const FrameNames& frames, const Noise& noise) {
  Imu imu{};
  imu.header = header_of(stamp_ns, frames.imu);
  imu.orientation = quaternion(Quaterniond::Identity());
  imu.orientation_covariance[0] = -1;
  imu.angular_velocity = vector(sample.angular_velocity_body_radps);
  copy(diagonal(noise.gyro_std_radps), imu.angular_velocity_covariance);
  imu.linear_acceleration = vector(sample.specific_force_body_mps2);
  copy(diagonal(noise.accel_std_mps2), imu.linear_acceleration_covariance);
  return imu;
}

Imu fused_imu(const ImuSample& sample, const FusedPose& pose, TimeNs stamp_ns, const FrameNames& frames,
              const Noise& noise) {
  Imu imu = raw_imu(sample, stamp_ns, frames, noise);
  imu.orientation = quaternion(pose.q_body_to_world);
  copy(orientation_covariance(pose, noise), imu.orientation_covariance);
  imu.angular_velocity = vector(pose.angular_velocity_body_radps);
  return imu;
}

std::optional<MagneticField> magnetic_field(const ImuSample& sample, TimeNs stamp_ns,
                                            const FrameNames& frames, const Noise& noise) {
  if (!sample.magnetic_field_body_t) return std::nullopt;
  MagneticField field{};
  field.header = header_of(stamp_ns, frames.imu);
  field.magnetic_field = vector(*sample.magnetic_field_body_t);
  copy(diagonal(noise.magnetic_std_t), field.magnetic_field_covariance);
  return field;
}

Odometry odometry(const FusedPose& pose, TimeNs stamp_ns, const FrameNames& frames, const Mount& mount,
                  const Noise& noise) {
  const BaseState base = base_state(pose, mount);
  Odometry odometry{};
  odometry.header = header_of(stamp_ns, frames.map);
  odometry.child_frame_id = borrow_string(frames.base);
  odometry.pose.pose = {point(base.position_map_m), quaternion(base.q_base_to_map)};
  copy(pose_covariance(pose, mount, noise), odometry.pose.covariance);
  odometry.twist.twist = {vector(base.velocity_base_mps), vector(base.angular_velocity_base_radps)};
  copy(twist_covariance(pose, mount, noise), odometry.twist.covariance);
  return odometry;
}

PoseWithCovarianceStamped pose_of(const Odometry& odometry) {
  return {odometry.header, odometry.pose};
}

PoseWithCovarianceStamped position_as_pose(const Vector3d& position_map_m, const Covariance3& covariance,
                                           TimeNs stamp_ns, const FrameNames& frames) {
  PoseWithCovarianceStamped pose{};
  pose.header = header_of(stamp_ns, frames.map);
  pose.pose.pose = {point(position_map_m), quaternion(Quaterniond::Identity())};
  copy(without_orientation(covariance), pose.pose.covariance);
  return pose;
}

PointStamped position_as_point(const Vector3d& position_map_m, TimeNs stamp_ns, const FrameNames& frames) {
  return {header_of(stamp_ns, frames.map), point(position_map_m)};
}

TransformStamped transform(const Transform& child_in_parent, TimeNs stamp_ns, const std::string& parent,
                           const std::string& child) {
  return {header_of(stamp_ns, parent),
          borrow_string(child),
          {vector(child_in_parent.translation_m), quaternion(child_in_parent.rotation)}};
}

Transform base_in_map(const Odometry& odometry) {
  const Point& p = odometry.pose.pose.position;
  const Quaternion& q = odometry.pose.pose.orientation;
  return {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

}  // namespace sonopose::ros2
