#pragma once
/// \file
/// ROS 2's messages as idlc made them from `idl/ros2`, under their own names.

#include <sonopose/dds/binding/topic.hpp>
#include <sonopose/idl/ros2/diagnostic_msgs.h>
#include <sonopose/idl/ros2/geometry_msgs.h>
#include <sonopose/idl/ros2/nav_msgs.h>
#include <sonopose/idl/ros2/rmw_dds_common.h>
#include <sonopose/idl/ros2/rmw_dds_common_humble.h>
#include <sonopose/idl/ros2/sensor_msgs.h>
#include <sonopose/idl/ros2/tf2_msgs.h>

namespace sonopose::ros2 {

using Time = builtin_interfaces_msg_dds__Time_;
using Header = std_msgs_msg_dds__Header_;
using Vector3 = geometry_msgs_msg_dds__Vector3_;
using Point = geometry_msgs_msg_dds__Point_;
using PointStamped = geometry_msgs_msg_dds__PointStamped_;
using Quaternion = geometry_msgs_msg_dds__Quaternion_;
using Pose = geometry_msgs_msg_dds__Pose_;
using PoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using PoseWithCovarianceStamped = geometry_msgs_msg_dds__PoseWithCovarianceStamped_;
using TransformStamped = geometry_msgs_msg_dds__TransformStamped_;
using Imu = sensor_msgs_msg_dds__Imu_;
using MagneticField = sensor_msgs_msg_dds__MagneticField_;
using Odometry = nav_msgs_msg_dds__Odometry_;
using Path = nav_msgs_msg_dds__Path_;
using TFMessage = tf2_msgs_msg_dds__TFMessage_;
using KeyValue = diagnostic_msgs_msg_dds__KeyValue_;
using DiagnosticStatus = diagnostic_msgs_msg_dds__DiagnosticStatus_;
using DiagnosticArray = diagnostic_msgs_msg_dds__DiagnosticArray_;
using ParticipantEntitiesInfo = rmw_dds_common_msg_dds__ParticipantEntitiesInfo_;
using HumbleParticipantEntitiesInfo = rmw_dds_common_humble_msg_dds__ParticipantEntitiesInfo_;

}  // namespace sonopose::ros2

namespace sonopose::dds {

template <>
struct TopicTraits<ros2::PointStamped> {
  static const dds_topic_descriptor_t& descriptor() { return geometry_msgs_msg_dds__PointStamped__desc; }
};

template <>
struct TopicTraits<ros2::PoseWithCovarianceStamped> {
  static const dds_topic_descriptor_t& descriptor() {
    return geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc;
  }
};

template <>
struct TopicTraits<ros2::Imu> {
  static const dds_topic_descriptor_t& descriptor() { return sensor_msgs_msg_dds__Imu__desc; }
};

template <>
struct TopicTraits<ros2::MagneticField> {
  static const dds_topic_descriptor_t& descriptor() { return sensor_msgs_msg_dds__MagneticField__desc; }
};

template <>
struct TopicTraits<ros2::Odometry> {
  static const dds_topic_descriptor_t& descriptor() { return nav_msgs_msg_dds__Odometry__desc; }
};

template <>
struct TopicTraits<ros2::Path> {
  static const dds_topic_descriptor_t& descriptor() { return nav_msgs_msg_dds__Path__desc; }
};

template <>
struct TopicTraits<ros2::TFMessage> {
  static const dds_topic_descriptor_t& descriptor() { return tf2_msgs_msg_dds__TFMessage__desc; }
};

template <>
struct TopicTraits<ros2::DiagnosticArray> {
  static const dds_topic_descriptor_t& descriptor() { return diagnostic_msgs_msg_dds__DiagnosticArray__desc; }
};

template <>
struct TopicTraits<ros2::ParticipantEntitiesInfo> {
  static const dds_topic_descriptor_t& descriptor() {
    return rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc;
  }
};

/// Two layouts have one name on the wire.
template <>
struct TopicTraits<ros2::HumbleParticipantEntitiesInfo> {
  static const dds_topic_descriptor_t& descriptor() {
    static const dds_topic_descriptor_t as_on_the_wire =
        renamed(rmw_dds_common_humble_msg_dds__ParticipantEntitiesInfo__desc,
                rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc.m_typename);
    return as_on_the_wire;
  }
};

}  // namespace sonopose::dds
