#pragma once
/// \file
/// Conversions of velocities from ROS 2 (wheel odometry) to the native type.

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Least standard deviation of a velocity along an axis that is not measured, as drivers state it.
inline constexpr double unmeasured_std_mps = 30.0;

/// The wheels of a differential drive. Wheels of one side turn alike.
struct Wheels {
  std::vector<std::string> left_joints;
  std::vector<std::string> right_joints;
  double radius_m = 0;
  double track_m = 0;  ///< distance between the left and the right wheels
};

/// Converts a velocity of the base in its axes to that of the IMU in body axes. An axis with a negative
/// variance, or a standard deviation from `unmeasured_std_mps` on, is not measured. Without any positive
/// variance the deviations are unknown. Unless the axes of the mount are parallel to those of the base, all
/// three must be measured. Empty for a non-finite value, an invalid stamp, or if no axis is measured.
///
/// `received_ns`: time of reception; the time of measurement of a message without a stamp.
std::optional<TwistSample> twist_sample(const Odometry& odometry, BeaconAddress address, const Mount& mount,
                                        TimeNs received_ns);
std::optional<TwistSample> twist_sample(const TwistWithCovarianceStamped& twist, BeaconAddress address,
                                        const Mount& mount, TimeNs received_ns);
std::optional<TwistSample> twist_sample(const TwistStamped& twist, BeaconAddress address, const Mount& mount,
                                        TimeNs received_ns);

/// Converts the speeds of wheels (rad/s, forward positive) to the velocity of the middle of their axle, which
/// is the base, along its x axis, and to its yaw rate. Empty also unless the message has the speeds of all
/// joints.
std::optional<TwistSample> twist_sample(const JointState& joints, const Wheels& wheels, BeaconAddress address,
                                        const Mount& mount, TimeNs received_ns);

}  // namespace sonopose::ros2
