#pragma once
/// \file
/// The project's ROS 2 message types, for programs that record topics without decoding.

#include <sonopose/dds/psm/serialized.hpp>
#include <sonopose/dds/qos/provider.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::ros2 {

struct SerializedType {
  std::string_view dds_name;  ///< such as "nav_msgs::msg::dds_::Odometry_"
  /// Makes a reader of a topic, given by its name in DDS. `listener` must outlive it.
  dds::SerializedReader (*make_reader)(const dds::domain::DomainParticipant& participant,
                                       const std::string& topic_in_dds, const dds::Qos& qos,
                                       dds::sub::DataReaderListener<dds::Serialized>* listener);
};

/// Types of topics; parts of messages are not listed.
std::span<const SerializedType> serialized_types();

/// Definition in the syntax of .msg files: the type, then each of its parts after a line of 80 "=" and "MSG:
/// pkg/Name". Generated from `idl/ros2` at build time. Throws std::invalid_argument for an unknown type.
std::string_view message_definition(std::string_view dds_type_name);

/// ROS 2 name of a topic in DDS: "rt/imu" → "/imu". Empty if it is not one of ROS 2.
std::optional<std::string> name_in_ros(const std::string& topic_in_dds);

/// Policies of a reader that matches a writer and gets all that it offers: as reliable and as durable.
dds::Qos matching_reader_qos(const dds::qos::Provider& qos, const dds::Qos& writer_qos);

/// QoS of a writer as ROS 2's recorder notes it, a list of one in YAML.
std::string qos_in_yaml(const dds::Qos& writer_qos);

}  // namespace sonopose::ros2
