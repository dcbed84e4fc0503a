#include "mavlink/messages.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

namespace sonopose::mavlink {
namespace {

static_assert(std::endian::native == std::endian::little, "MAVLink is little-endian, like our hosts");

/// Appends fields to the payload of a frame.
class Writer {
public:
  Writer(std::uint32_t message_id, Identity sender) { frame_ = {.message_id = message_id, .sender = sender}; }

  template <class T>
  Writer& add(T value) {
    static_assert(std::is_arithmetic_v<T>);
    std::memcpy(frame_.payload.data() + frame_.size, &value, sizeof value);
    frame_.size += sizeof value;
    return *this;
  }

  template <class Vector>
  Writer& add_floats(const Vector& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) add(static_cast<float>(values[i]));
    return *this;
  }

  /// The upper triangle, row by row.
  Writer& add_covariance(const autopilot::Matrix6& covariance) {
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) add(static_cast<float>(covariance(row, column)));
    }
    return *this;
  }

  [[nodiscard]] const Frame& frame() const { return frame_; }

private:
  Frame frame_;
};

/// Field of a payload; zero beyond its transmitted part.
template <class T>
T field(const Frame& frame, std::size_t offset) {
  T value{};
  std::memcpy(&value, frame.payload.data() + offset, sizeof value);
  return value;
}

}  // namespace

Frame heartbeat(Identity sender) {
  constexpr std::uint8_t onboard_controller = 18;  // MAV_TYPE
  constexpr std::uint8_t active = 4;               // MAV_STATE
  constexpr std::uint8_t protocol_version = 3;
  return Writer(heartbeat_id, sender)
      .add(std::uint32_t{0})
      .add(onboard_controller)
      .add(autopilot_none)
      .add(std::uint8_t{0})
      .add(active)
      .add(protocol_version)
      .frame();
}

std::optional<std::uint8_t> autopilot_of(const Frame& frame) {
  constexpr std::size_t autopilot_offset = 5;
  if (frame.message_id != heartbeat_id) return std::nullopt;
  const auto autopilot = field<std::uint8_t>(frame, autopilot_offset);
  return autopilot == autopilot_none ? std::nullopt : std::optional(autopilot);
}

std::optional<Frame> timesync_answer(const Frame& request, Identity sender, TimeNs now_ns) {
  if (request.message_id != timesync_id || field<std::int64_t>(request, 0) != 0) return std::nullopt;
  return Writer(timesync_id, sender)
      .add(std::int64_t{now_ns})
      .add(field<std::int64_t>(request, 8))
      .add(request.sender.system)
      .add(request.sender.component)
      .frame();
}

Frame odometry(const autopilot::ExternalOdometry& odometry, Identity sender,
               const PoseMessageFields& fields) {
  constexpr std::uint8_t local_ned = 1;  // MAV_FRAME
  constexpr std::uint8_t body_frd = 12;
  constexpr std::uint8_t local_frd = 20;
  // MAV_ESTIMATOR_TYPE. PX4 drops ODOMETRY of every estimator but naive, vision, VIO and motion capture.
  constexpr std::uint8_t vision = 2;
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector4d q = Eigen::Vector4d::Constant(unknown);
  if (const auto& known = odometry.q_body_to_frame) q << known->w(), known->x(), known->y(), known->z();
  autopilot::Matrix6 twist = autopilot::Matrix6::Constant(unknown);
  twist.topLeftCorner<3, 3>() = odometry.velocity_covariance_body;
  return Writer(odometry_id, sender)
      .add(autopilot::to_us(fields.time_ns))
      .add_floats(odometry.position_frame_m)
      .add_floats(q)
      .add_floats(odometry.velocity_body_mps)
      .add_floats(odometry.angular_velocity_body_radps)
      .add_covariance(odometry.pose_covariance)
      .add_covariance(twist)
      .add(fields.in_ned ? local_ned : local_frd)
      .add(body_frd)
      .add(fields.reset_counter)
      .add(vision)
      .add(static_cast<std::int8_t>(fields.quality_percent))
      .frame();
}

Frame vision_position_estimate(const autopilot::ExternalOdometry& odometry, Identity sender,
                               const PoseMessageFields& fields) {
  Vector3d angles = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (odometry.q_body_to_frame) {
    const auto euler = geometry::euler_angles_of(*odometry.q_body_to_frame);
    angles = {euler.roll_rad, euler.pitch_rad, euler.yaw_rad};
  }
  return Writer(vision_position_estimate_id, sender)
      .add(autopilot::to_us(fields.time_ns))
      .add_floats(odometry.position_frame_m)
      .add_floats(angles)
      .add_covariance(odometry.pose_covariance)
      .add(fields.reset_counter)
      .frame();
}

}  // namespace sonopose::mavlink
