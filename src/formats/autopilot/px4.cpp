#include "autopilot/px4.hpp"

#include <cstddef>
#include <limits>

namespace sonopose::autopilot {
namespace {

constexpr std::uint8_t frame_ned = 1;
constexpr std::uint8_t frame_frd = 2;

/// Copies to an array of the IDL.
template <std::size_t size, class Values>
void fill(float (&to)[size], const Values& values) {  // NOLINT(modernize-avoid-c-arrays)
  for (std::size_t i = 0; i < size; ++i) to[i] = static_cast<float>(values[static_cast<Eigen::Index>(i)]);
}

/// w first, of length 1 to the last bit of a float: PX4 drops others.
Eigen::Vector4f quaternion(const std::optional<Quaterniond>& q) {
  if (!q) return Eigen::Vector4f::Constant(std::numeric_limits<float>::quiet_NaN());
  return Eigen::Vector4d(q->w(), q->x(), q->y(), q->z()).cast<float>().normalized();
}

}  // namespace

ros2::VehicleOdometry vehicle_odometry(const ExternalOdometry& odometry, TimeNs measured_ns, TimeNs now_ns,
                                       std::uint8_t reset_counter, std::uint8_t quality_percent) {
  ros2::VehicleOdometry message{};
  message.timestamp = to_us(now_ns);
  message.timestamp_sample = to_us(measured_ns);
  message.pose_frame = odometry.is_ned ? frame_ned : frame_frd;
  message.velocity_frame = message.pose_frame;
  fill(message.position, odometry.position_frame_m);
  fill(message.q, quaternion(odometry.q_body_to_frame));
  fill(message.velocity, odometry.velocity_frame_mps);
  fill(message.angular_velocity, odometry.angular_velocity_body_radps);
  fill(message.position_variance, odometry.pose_covariance.diagonal().head<3>());
  fill(message.orientation_variance, odometry.orientation_variance_body_rad2);
  fill(message.velocity_variance, odometry.velocity_covariance_frame.diagonal());
  message.reset_counter = reset_counter;
  message.quality = static_cast<std::int8_t>(quality_percent);
  return message;
}

}  // namespace sonopose::autopilot
