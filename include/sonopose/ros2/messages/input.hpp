#pragma once
/// \file
/// Conversions from ROS 2 messages to native types, for ROS 2 drivers of IMUs and positioning systems.

#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::ros2 {

// `received_ns`: time of reception, host clock. It is also the measurement time of a message with stamp 0,
// which means no stamp.

/// A sample of an IMU, or of one of its two sensors.
struct ReceivedImu {
  ImuSample sample;  ///< zero where there is no data
  bool has_angular_velocity = true;
  bool has_specific_force = true;
};

/// Converts sensor_msgs/Imu: angular velocity (rad/s) and specific force (m/s², +g on z at rest, REP-145) in
/// the axes of the sensor. A part whose covariance begins with -1 is no data (REP-145). The orientation is
/// not used. Empty for a non-finite value or an invalid stamp.
std::optional<ReceivedImu> imu_sample(const Imu& imu, BeaconAddress address, TimeNs received_ns);

/// Converts px4_msgs/SensorCombined, from FRD. PX4 states means over an interval that ends at the stamp, and
/// its client leaves samples out, so a sample is an instant in the middle of its interval. Empty for a
/// non-finite value or an invalid stamp.
std::optional<ReceivedImu> imu_sample(const SensorCombined& imu, BeaconAddress address);

/// Converts a position in the map (m), with the measured delay from its stamp to `received_ns`. The
/// orientation is not used. A stamp after `received_ns`, of a clock slightly ahead, means no delay. Empty for
/// a non-finite position or an invalid stamp.
std::optional<UltrasonicFix> fix(const PointStamped& point, BeaconAddress address, TimeNs received_ns);
/// Overload with the covariance of the position. It is unknown if all variances are zero, and if it is
/// unusable (covariance_fault). A variance above `max_fix_std_m` means that this axis alone is unknown. Each
/// standard deviation is at least `min_fix_std_m`.
std::optional<UltrasonicFix> fix(const PoseWithCovarianceStamped& pose, BeaconAddress address,
                                 TimeNs received_ns);

/// The first element of a covariance (m²) that makes it unusable.
struct CovarianceFault {
  int row = 0;
  int column = 0;
  double value_m2 = 0;
  const char* reason = "";  ///< "not finite", "negative", "above …", "not symmetric", …
};

/// Examines the position's covariance. Empty if it is usable, also with an unknown axis, or if all variances
/// are zero.
std::optional<CovarianceFault> covariance_fault(const PoseWithCovarianceStamped& pose);

/// Greatest standard deviation of a fix that says anything: drivers state more where they know nothing.
inline constexpr double max_fix_std_m = 100;

/// Least standard deviation of a fix. A moving body is hardly ever located better: a stamp that is off by 10
/// ms gives 1 cm at 1 m/s. Drivers also leave single variances 0, or state the resolution of their output.
inline constexpr double min_fix_std_m = 0.01;

}  // namespace sonopose::ros2
