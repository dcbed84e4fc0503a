#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>

namespace sonopose::ros2 {
namespace {

/// Returns the time of measurement: the stamp, or the time of reception without one.
std::optional<TimeNs> measured_at(const Header& header, TimeNs received_ns) {
  if (header.stamp.sec == 0 && header.stamp.nanosec == 0) return received_ns;
  return from_ros(header.stamp);
}

std::optional<UltrasonicFix> fix_at(const Header& header, const Point& position, BeaconAddress address,
                                    TimeNs received_ns) {
  const auto emission_ns = measured_at(header, received_ns);
  UltrasonicFix fix;
  fix.address = address;
  fix.position_world_m = {position.x, position.y, position.z};
  if (!emission_ns || !fix.position_world_m.allFinite()) return std::nullopt;
  fix.emission_time_ns = *emission_ns;
  fix.received_time_ns = std::max(*emission_ns, received_ns);
  fix.measured_delay_s = seconds_between(*emission_ns, fix.received_time_ns);
  return fix;
}

/// Returns empty if the sender does not know it.
std::optional<Covariance<3>> position_covariance(const PoseWithCovarianceStamped& pose) {
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> all(&pose.pose.covariance[0]);
  const Eigen::Matrix3d stated = all.topLeftCorner<3, 3>();
  if (!stated.allFinite() || !(stated.diagonal().maxCoeff() > 0)) return std::nullopt;
  const Vector3d variances = stated.diagonal().cwiseMax(min_fix_std_m * min_fix_std_m);
  Eigen::Matrix3d bounded = stated;
  bounded.diagonal() = variances;
  const bool is_covariance = Eigen::LLT<Eigen::Matrix3d>(bounded).info() == Eigen::Success;
  return is_covariance ? Covariance<3>::from_matrix(bounded) : Covariance<3>::from_diagonal(variances);
}

}  // namespace

std::optional<ImuSample> imu_sample(const Imu& imu, BeaconAddress address, TimeNs received_ns) {
  const auto sensor_ns = measured_at(imu.header, received_ns);
  ImuSample sample;
  sample.address = address;
  sample.angular_velocity_body_radps = {imu.angular_velocity.x, imu.angular_velocity.y,
                                        imu.angular_velocity.z};
  sample.specific_force_body_mps2 = {imu.linear_acceleration.x, imu.linear_acceleration.y,
                                     imu.linear_acceleration.z};
  if (!sensor_ns || !sample.angular_velocity_body_radps.allFinite() ||
      !sample.specific_force_body_mps2.allFinite()) {
    return std::nullopt;
  }
  sample.sensor_time_ns = *sensor_ns;
  return sample;
}

std::optional<UltrasonicFix> fix(const PointStamped& point, BeaconAddress address, TimeNs received_ns) {
  return fix_at(point.header, point.point, address, received_ns);
}

std::optional<UltrasonicFix> fix(const PoseWithCovarianceStamped& pose, BeaconAddress address,
                                 TimeNs received_ns) {
  auto fix = fix_at(pose.header, pose.pose.pose.position, address, received_ns);
  if (fix) fix->covariance_world_m2 = position_covariance(pose);
  return fix;
}

}  // namespace sonopose::ros2
