#pragma once
/// \file
/// Prints ROS 2 messages of Fast DDS as one line of text, all fields in message order.

#include "diagnostic_msgs.h"
#include "nav_msgs.h"
#include "px4_msgs.h"
#include "rmw_dds_common.h"
#include "rosgraph_msgs.h"
#include "sensor_msgs.h"
#include "tf2_msgs.h"

#include <array>
#include <bit>
#include <cstdint>
#include <fastrtps/utils/fixed_size_string.hpp>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

/// Doubles are decimal, or the 16 hexadecimal digits of their bits; strings are in quotation marks; a
/// sequence begins with its [length].
class MessageText {
public:
  explicit MessageText(bool bits) : bits_(bits) {}

  template <class... Field>
  void fields(const Field&... field) {
    (add(field), ...);
  }
  std::string line() const { return out_.str().substr(1); }

private:
  void add(double value) {
    if (bits_) {
      const auto raw = std::bit_cast<std::uint64_t>(value);
      out_ << ' ' << std::hex << std::setw(16) << std::setfill('0') << raw << std::dec;
    } else {
      out_ << ' ' << value;
    }
  }
  void add(float value) { add(double{value}); }
  void add(std::int64_t value) { out_ << ' ' << value; }
  void add(std::uint64_t value) { out_ << ' ' << value; }
  void add(std::int8_t value) { out_ << ' ' << +value; }
  void add(std::int32_t value) { out_ << ' ' << value; }
  void add(std::uint32_t value) { out_ << ' ' << value; }
  void add(std::uint8_t value) { out_ << ' ' << +value; }
  void add(const std::string& value) { out_ << " \"" << value << '"'; }
  template <std::size_t n>
  void add(const eprosima::fastrtps::fixed_string<n>& value) {
    add(value.to_string());
  }
  template <class Number, std::size_t n>
  void add(const std::array<Number, n>& values) {
    for (const Number value : values) add(value);
  }
  template <class Element>
  void add(const std::vector<Element>& elements) {
    out_ << " [" << elements.size() << ']';
    for (const Element& element : elements) add(element);
  }

  void add(const builtin_interfaces::msg::dds_::Time_& m) { fields(m.sec(), m.nanosec()); }
  void add(const std_msgs::msg::dds_::Header_& m) { fields(m.stamp(), m.frame_id()); }
  void add(const geometry_msgs::msg::dds_::Vector3_& m) { fields(m.x(), m.y(), m.z()); }
  void add(const geometry_msgs::msg::dds_::Point_& m) { fields(m.x(), m.y(), m.z()); }
  void add(const geometry_msgs::msg::dds_::Quaternion_& m) { fields(m.x(), m.y(), m.z(), m.w()); }
  void add(const geometry_msgs::msg::dds_::PoseWithCovariance_& m) { fields(m.pose(), m.covariance()); }
  void add(const geometry_msgs::msg::dds_::TwistWithCovariance_& m) {
    fields(m.twist().linear(), m.twist().angular(), m.covariance());
  }
  void add(const geometry_msgs::msg::dds_::TransformStamped_& m) {
    fields(m.header(), m.child_frame_id(), m.transform().translation(), m.transform().rotation());
  }
  void add(const diagnostic_msgs::msg::dds_::KeyValue_& m) { fields(m.key(), m.value()); }
  void add(const diagnostic_msgs::msg::dds_::DiagnosticStatus_& m) {
    fields(m.level(), m.name(), m.message(), m.hardware_id(), m.values());
  }
  void add(const sensor_msgs::msg::dds_::Imu_& m) {
    fields(m.header(), m.orientation(), m.orientation_covariance(), m.angular_velocity(),
           m.angular_velocity_covariance(), m.linear_acceleration(), m.linear_acceleration_covariance());
  }
  void add(const nav_msgs::msg::dds_::Odometry_& m) {
    fields(m.header(), m.child_frame_id(), m.pose(), m.twist());
  }
  void add(const geometry_msgs::msg::dds_::Pose_& m) { fields(m.position(), m.orientation()); }
  void add(const geometry_msgs::msg::dds_::PoseStamped_& m) { fields(m.header(), m.pose()); }
  void add(const geometry_msgs::msg::dds_::PoseWithCovarianceStamped_& m) { fields(m.header(), m.pose()); }
  void add(const geometry_msgs::msg::dds_::PointStamped_& m) { fields(m.header(), m.point()); }
  void add(const sensor_msgs::msg::dds_::MagneticField_& m) {
    fields(m.header(), m.magnetic_field(), m.magnetic_field_covariance());
  }
  void add(const nav_msgs::msg::dds_::Path_& m) { fields(m.header(), m.poses()); }
  void add(const rosgraph_msgs::msg::dds_::Clock_& m) { fields(m.clock()); }
  void add(const px4_msgs::msg::dds_::VehicleOdometry_& m) {
    fields(m.timestamp(), m.timestamp_sample(), m.pose_frame(), m.position(), m.q(), m.velocity_frame(),
           m.velocity(), m.angular_velocity(), m.position_variance(), m.orientation_variance(),
           m.velocity_variance(), m.reset_counter(), m.quality());
  }
  void add(const px4_msgs::msg::dds_::TimesyncStatus_& m) {
    fields(m.timestamp(), m.source_protocol(), m.remote_timestamp(), m.observed_offset(),
           m.estimated_offset(), m.round_trip_time());
  }
  void add(const rmw_dds_common::msg::dds_::Gid_& m) { fields(m.data()); }
  void add(const rmw_dds_common::msg::dds_::NodeEntitiesInfo_& m) {
    fields(m.node_namespace(), m.node_name(), m.reader_gid_seq(), m.writer_gid_seq());
  }
  void add(const rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_& m) {
    fields(m.gid(), m.node_entities_info_seq());
  }
  void add(const tf2_msgs::msg::dds_::TFMessage_& m) { fields(m.transforms()); }
  void add(const diagnostic_msgs::msg::dds_::DiagnosticArray_& m) { fields(m.header(), m.status()); }

  bool bits_;
  std::ostringstream out_;
};

template <class Message>
std::string text_of(const Message& message, bool bits) {
  MessageText text(bits);
  text.fields(message);
  return text.line();
}
