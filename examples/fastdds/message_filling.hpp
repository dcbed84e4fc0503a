#pragma once
/// \file
/// Fills ROS 2 messages of Fast DDS: the present time, and numbers.

#include "geometry_msgs.h"
#include "px4_msgs.h"
#include "rosgraph_msgs.h"
#include "sensor_msgs.h"
#include "tf2_msgs.h"

#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

/// Bits of doubles.
using Bits = std::vector<std::uint64_t>;

/// Fills numbers cyclically with the given doubles.
class MessageFiller {
public:
  explicit MessageFiller(Bits bits)
      : bits_(bits.empty() ? Bits{std::bit_cast<std::uint64_t>(1.0)} : std::move(bits)) {}

  void fill(sensor_msgs::msg::dds_::Imu_& m) {
    fill(m.header(), "imu_link");
    fill(m.orientation());
    fill(m.orientation_covariance());
    fill_vector(m.angular_velocity());
    fill(m.angular_velocity_covariance());
    fill_vector(m.linear_acceleration());
    fill(m.linear_acceleration_covariance());
  }
  void fill(geometry_msgs::msg::dds_::PointStamped_& m) {
    fill(m.header(), "map");
    fill_vector(m.point());
  }
  void fill(geometry_msgs::msg::dds_::PoseWithCovarianceStamped_& m) {
    fill(m.header(), "map");
    fill_vector(m.pose().pose().position());
    fill(m.pose().pose().orientation());
    fill(m.pose().covariance());
  }
  void fill(tf2_msgs::msg::dds_::TFMessage_& m) {
    m.transforms().resize(1);
    auto& transform = m.transforms()[0];
    fill(transform.header(), "odom");
    transform.child_frame_id("base_link");
    fill_vector(transform.transform().translation());
    fill(transform.transform().rotation());
  }
  void fill(rosgraph_msgs::msg::dds_::Clock_& m) { fill(m.clock()); }
  /// The clock of the agent's machine.
  static void fill(px4_msgs::msg::dds_::TimesyncStatus_& m) {
    using std::chrono::microseconds;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    m.timestamp(static_cast<std::uint64_t>(std::chrono::duration_cast<microseconds>(now).count()));
    m.remote_timestamp(m.timestamp());
    m.source_protocol(2);
  }

private:
  double next() { return std::bit_cast<double>(bits_[next_++ % bits_.size()]); }

  static void fill(builtin_interfaces::msg::dds_::Time_& m) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto now_s = std::chrono::duration_cast<std::chrono::seconds>(now);
    m.sec(static_cast<std::int32_t>(now_s.count()));
    m.nanosec(static_cast<std::uint32_t>(std::chrono::nanoseconds(now - now_s).count()));
  }
  static void fill(std_msgs::msg::dds_::Header_& m, const char* frame) {
    fill(m.stamp());
    m.frame_id(frame);
  }
  /// Vector3_ or Point_.
  template <class Vector>
  void fill_vector(Vector& m) {
    for (double* const field : {&m.x(), &m.y(), &m.z()}) *field = next();
  }
  void fill(geometry_msgs::msg::dds_::Quaternion_& m) {
    for (double* const field : {&m.x(), &m.y(), &m.z(), &m.w()}) *field = next();
  }
  template <std::size_t n>
  void fill(std::array<double, n>& values) {
    for (double& value : values) value = next();
  }

  Bits bits_;
  std::size_t next_ = 0;
};
