#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/ros2/messages/twist_input.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sonopose::ros2 {
namespace {

/// A velocity of the base in its own axes.
struct BaseTwist {
  Vector3d velocity_mps = Vector3d::Zero();
  Vector3d std_mps = Vector3d::Constant(-1.0);  ///< negative: unknown
  Eigen::Array<bool, 3, 1> is_measured{true, true, true};
  Vector3d angular_velocity_radps = Vector3d::Zero();
};

BaseTwist base_twist(const geometry_msgs_msg_dds__Twist_& twist) {
  BaseTwist base;
  base.velocity_mps = {twist.linear.x, twist.linear.y, twist.linear.z};
  base.angular_velocity_radps = {twist.angular.x, twist.angular.y, twist.angular.z};
  return base;
}

BaseTwist base_twist(const geometry_msgs_msg_dds__TwistWithCovariance_& twist) {
  constexpr std::size_t columns = 6;
  BaseTwist base = base_twist(twist.twist);
  Vector3d variances;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    variances[static_cast<Eigen::Index>(axis)] = twist.covariance[axis * (columns + 1)];
  }
  const bool is_known = (variances.array() > 0.0).any();
  for (int axis = 0; axis < 3; ++axis) {
    base.is_measured[axis] =
        variances[axis] >= 0.0 && variances[axis] < unmeasured_std_mps * unmeasured_std_mps;
    if (is_known && base.is_measured[axis]) base.std_mps[axis] = std::sqrt(variances[axis]);
  }
  return base;
}

/// Sets the axes of the body, each of which is one of the base or, if all are measured, any direction.
void set_body_axes(TwistSample& twist, const BaseTwist& base, const Mount& mount) {
  constexpr double parallel = 0.999;  // 2.6°
  const Eigen::Matrix3d to_body = mount.q_imu_to_base.toRotationMatrix().transpose();
  const Vector3d imu_base_mps = base.velocity_mps + base.angular_velocity_radps.cross(mount.imu_in_base_m);
  twist.velocity_body_mps = to_body * imu_base_mps;
  twist.angular_velocity_body_radps = to_body * base.angular_velocity_radps;
  twist.axes = twist_angular_velocity_x | twist_angular_velocity_y | twist_angular_velocity_z;
  const bool has_all = base.is_measured.all();
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Index of_base = 0;
    const double along = to_body.row(axis).cwiseAbs().maxCoeff(&of_base);
    if (!has_all && (along < parallel || !base.is_measured[of_base])) continue;
    twist.axes |= twist_velocity_x << axis;
    twist.velocity_std_mps[axis] = along < parallel ? base.std_mps.maxCoeff() : base.std_mps[of_base];
  }
}

std::optional<TwistSample> sample_of(const Header& header, const BaseTwist& base, BeaconAddress address,
                                     const Mount& mount, TimeNs received_ns) {
  const bool has_stamp = header.stamp.sec != 0 || header.stamp.nanosec != 0;
  const auto measured_ns = has_stamp ? from_ros(header.stamp) : std::optional(received_ns);
  TwistSample twist;
  twist.address = address;
  set_body_axes(twist, base, mount);
  constexpr std::uint32_t linear = twist_velocity_x | twist_velocity_y | twist_velocity_z;
  if (!measured_ns || (twist.axes & linear) == 0 || !twist.velocity_body_mps.allFinite() ||
      !twist.velocity_std_mps.allFinite() || !twist.angular_velocity_body_radps.allFinite()) {
    return std::nullopt;
  }
  twist.emission_time_ns = *measured_ns;
  twist.received_time_ns = std::max(*measured_ns, received_ns);
  return twist;
}

/// Mean speed of joints; NaN unless the message has all of them.
double mean_speed_radps(const JointState& state, const std::vector<std::string>& joints) {
  double sum_radps = 0;
  for (const std::string& joint : joints) {
    std::uint32_t i = 0;
    while (i < state.name._length && joint != state.name._buffer[i]) ++i;
    if (i >= std::min(state.name._length, state.velocity._length)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    sum_radps += state.velocity._buffer[i];
  }
  return sum_radps / static_cast<double>(joints.size());
}

}  // namespace

std::optional<TwistSample> twist_sample(const Odometry& odometry, BeaconAddress address, const Mount& mount,
                                        TimeNs received_ns) {
  return sample_of(odometry.header, base_twist(odometry.twist), address, mount, received_ns);
}

std::optional<TwistSample> twist_sample(const TwistWithCovarianceStamped& twist, BeaconAddress address,
                                        const Mount& mount, TimeNs received_ns) {
  return sample_of(twist.header, base_twist(twist.twist), address, mount, received_ns);
}

std::optional<TwistSample> twist_sample(const TwistStamped& twist, BeaconAddress address, const Mount& mount,
                                        TimeNs received_ns) {
  return sample_of(twist.header, base_twist(twist.twist), address, mount, received_ns);
}

std::optional<TwistSample> twist_sample(const JointState& joints, const Wheels& wheels, BeaconAddress address,
                                        const Mount& mount, TimeNs received_ns) {
  const double left_mps = wheels.radius_m * mean_speed_radps(joints, wheels.left_joints);
  const double right_mps = wheels.radius_m * mean_speed_radps(joints, wheels.right_joints);
  BaseTwist base;
  base.velocity_mps.x() = 0.5 * (left_mps + right_mps);
  base.angular_velocity_radps.z() = (right_mps - left_mps) / wheels.track_m;
  base.is_measured = {true, false, false};
  return sample_of(joints.header, base, address, mount, received_ns);
}

}  // namespace sonopose::ros2
