#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

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

/// Returns the position's part of a covariance.
Eigen::Matrix3d position_part(const PoseWithCovarianceStamped& pose) {
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> all(&pose.pose.covariance[0]);
  return all.topLeftCorner<3, 3>();
}

/// Raises variances to the least one.
Eigen::Matrix3d bounded(Eigen::Matrix3d covariance) {
  covariance.diagonal() = covariance.diagonal().cwiseMax(min_fix_std_m * min_fix_std_m).eval();
  return covariance;
}

/// Returns the reason why one element is unusable; null if it is usable.
const char* fault_of(const Eigen::Matrix3d& stated, int row, int column) {
  constexpr double asymmetry = 1e-6;  // relative; some drivers compute with float
  const double value = stated(row, column);
  if (!std::isfinite(value)) return "not finite";
  if (row == column && value < 0) return "negative";
  if (std::abs(value) > max_fix_std_m * max_fix_std_m) return "above (100 m)²";
  const double difference = std::abs(value - stated(column, row));
  return difference > asymmetry * std::abs(value) + std::numeric_limits<double>::min() ? "not symmetric"
                                                                                       : nullptr;
}

/// Gives axes with a greater variance the greatest one, without correlations. Returns their number.
int limit_unknown_axes(Eigen::Matrix3d& covariance) {
  constexpr double max_m2 = max_fix_std_m * max_fix_std_m;
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(covariance(i, i) > max_m2)) continue;
    covariance.row(i).setZero();
    covariance.col(i).setZero();
    covariance(i, i) = max_m2;
    ++count;
  }
  return count;
}

/// Returns the first fault.
std::optional<CovarianceFault> fault_in(const Eigen::Matrix3d& stated) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const char* const reason = fault_of(stated, row, column);
      if (reason != nullptr) return CovarianceFault{row, column, stated(row, column), reason};
    }
  }
  if (Eigen::LLT<Eigen::Matrix3d>(bounded(stated)).info() == Eigen::Success) return std::nullopt;
  Eigen::Index row = 0;
  Eigen::Index column = 0;
  const Eigen::Matrix3d upper = stated.triangularView<Eigen::StrictlyUpper>();
  upper.cwiseAbs().maxCoeff(&row, &column);
  return CovarianceFault{static_cast<int>(row), static_cast<int>(column), stated(row, column),
                         "not positive definite"};
}

/// Returns the position's covariance, with its unknown axes limited unless all are unknown. Empty if all
/// variances are zero.
std::optional<Eigen::Matrix3d> stated_covariance(const PoseWithCovarianceStamped& pose) {
  const Eigen::Matrix3d stated = position_part(pose);
  if (stated.diagonal().isZero(0)) return std::nullopt;
  Eigen::Matrix3d limited = stated;
  return limit_unknown_axes(limited) < 3 ? limited : stated;
}

/// Returns empty if the sender does not know it.
std::optional<Covariance<3>> position_covariance(const PoseWithCovarianceStamped& pose) {
  const auto stated = stated_covariance(pose);
  if (!stated || fault_in(*stated)) return std::nullopt;
  return Covariance<3>::from_matrix(bounded(*stated));
}

Vector3d vector_of(const Vector3& vector) {
  return {vector.x, vector.y, vector.z};
}

/// Returns true if REP-145 marks the data of this covariance as absent.
bool is_absent(const double* covariance) {
  return covariance[0] == -1;
}

}  // namespace

std::optional<CovarianceFault> covariance_fault(const PoseWithCovarianceStamped& pose) {
  const auto stated = stated_covariance(pose);
  return stated ? fault_in(*stated) : std::nullopt;
}

std::optional<ReceivedImu> imu_sample(const Imu& imu, BeaconAddress address, TimeNs received_ns) {
  const auto sensor_ns = measured_at(imu.header, received_ns);
  ReceivedImu received;
  ImuSample& sample = received.sample;
  sample.address = address;
  const Vector3d force = vector_of(imu.linear_acceleration);
  received.has_angular_velocity = !is_absent(imu.angular_velocity_covariance);
  received.has_specific_force = !is_absent(imu.linear_acceleration_covariance);
  if (received.has_angular_velocity) sample.angular_velocity_body_radps = vector_of(imu.angular_velocity);
  if (received.has_specific_force) sample.specific_force_body_mps2 = force;
  if (!sensor_ns || !sample.angular_velocity_body_radps.allFinite() ||
      !sample.specific_force_body_mps2.allFinite()) {
    return std::nullopt;
  }
  sample.sensor_time_ns = *sensor_ns;
  return received;
}

std::optional<ReceivedImu> imu_sample(const SensorCombined& imu, BeaconAddress address) {
  constexpr std::int32_t no_accelerometer = std::numeric_limits<std::int32_t>::max();
  constexpr std::uint32_t max_interval_us = 1'000'000;
  const auto from_frd = [](const float(&v)[3]) {  // NOLINT(modernize-avoid-c-arrays): the IDL's
    return Vector3d(v[0], -v[1], -v[2]);
  };
  if (imu.timestamp >= static_cast<std::uint64_t>(end_of_time_ns / 1000)) return std::nullopt;
  const auto half_interval_us = std::min(imu.gyro_integral_dt, max_interval_us) / 2;
  ReceivedImu received;
  received.sample.address = address;
  received.sample.sensor_time_ns = (static_cast<TimeNs>(imu.timestamp) - half_interval_us) * 1000;
  received.sample.meaning = ImuMeaning::instant;
  received.sample.angular_velocity_body_radps = from_frd(imu.gyro_rad);
  received.has_specific_force = imu.accelerometer_timestamp_relative != no_accelerometer;
  if (received.has_specific_force)
    received.sample.specific_force_body_mps2 = from_frd(imu.accelerometer_m_s2);
  const bool is_valid = received.sample.sensor_time_ns > 0 &&
                        received.sample.angular_velocity_body_radps.allFinite() &&
                        received.sample.specific_force_body_mps2.allFinite();
  return is_valid ? std::optional(received) : std::nullopt;
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
