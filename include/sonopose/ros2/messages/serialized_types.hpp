#pragma once
/// \file
/// The message types of ROS 2 that this project has, for programs that record their topics without a
/// decoding.

#include <sonopose/dds/binding/serialized.hpp>
#include <sonopose/dds/qos/provider.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::ros2 {

struct SerializedType {
  std::string_view dds_name;  ///< "nav_msgs::msg::dds_::Odometry_"
  /// A reader of a topic by its name in DDS. `listener` must outlive it.
  dds::SerializedReader (*make_reader)(const dds::DomainParticipant& participant,
                                       const std::string& topic_in_dds, const dds::Qos& qos,
                                       dds::DataReaderListener<dds::Serialized>* listener);
};

/// Those of topics; parts of messages are not listed.
std::span<const SerializedType> serialized_types();

/// The definition as .msg files write it: the type, then each one that it consists of after a line of 80 "="
/// and "MSG: pkg/Name". Generated from `idl/ros2` at build time. Throws std::invalid_argument for a type that
/// is not there.
std::string_view message_definition(std::string_view dds_type_name);

/// The name in ROS 2 of a topic in DDS: "rt/imu" → "/imu". Empty if it is none of ROS 2.
std::optional<std::string> name_in_ros(const std::string& topic_in_dds);

/// The policies of a reader that matches a writer and gets all that it offers: as reliable and as durable as
/// it.
dds::Qos matching_reader_qos(const dds::qos::Provider& qos, const dds::Qos& writer_qos);

/// The QoS of a writer as ROS 2's recorder notes it, a list of one in YAML.
std::string qos_in_yaml(const dds::Qos& writer_qos);

}  // namespace sonopose::ros2
