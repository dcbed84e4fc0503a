#pragma once
/// \file
/// The services that the relay's node offers, as idlc made them from `idl/ros2`, under their own names.

#include <sonopose/dds/binding/topic.hpp>
#include <sonopose/idl/ros2/rcl_interfaces.h>
#include <sonopose/idl/ros2/std_srvs.h>

namespace sonopose::ros2 {

using ParameterValue = rcl_interfaces_msg_dds__ParameterValue_;
using Parameter = rcl_interfaces_msg_dds__Parameter_;
using ParameterDescriptor = rcl_interfaces_msg_dds__ParameterDescriptor_;
using FloatingPointRange = rcl_interfaces_msg_dds__FloatingPointRange_;
using IntegerRange = rcl_interfaces_msg_dds__IntegerRange_;
using SetParametersResult = rcl_interfaces_msg_dds__SetParametersResult_;

/// A service's two types.
struct ListParameters {
  using Request = rcl_interfaces_srv_dds__ListParameters_Request_;
  using Response = rcl_interfaces_srv_dds__ListParameters_Response_;
};
struct GetParameters {
  using Request = rcl_interfaces_srv_dds__GetParameters_Request_;
  using Response = rcl_interfaces_srv_dds__GetParameters_Response_;
};
struct GetParameterTypes {
  using Request = rcl_interfaces_srv_dds__GetParameterTypes_Request_;
  using Response = rcl_interfaces_srv_dds__GetParameterTypes_Response_;
};
struct DescribeParameters {
  using Request = rcl_interfaces_srv_dds__DescribeParameters_Request_;
  using Response = rcl_interfaces_srv_dds__DescribeParameters_Response_;
};
struct SetParameters {
  using Request = rcl_interfaces_srv_dds__SetParameters_Request_;
  using Response = rcl_interfaces_srv_dds__SetParameters_Response_;
};
struct SetParametersAtomically {
  using Request = rcl_interfaces_srv_dds__SetParametersAtomically_Request_;
  using Response = rcl_interfaces_srv_dds__SetParametersAtomically_Response_;
};
struct Trigger {
  using Request = std_srvs_srv_dds__Trigger_Request_;
  using Response = std_srvs_srv_dds__Trigger_Response_;
};

}  // namespace sonopose::ros2

namespace sonopose::dds {

template <>
struct TopicTraits<ros2::ListParameters::Request> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__ListParameters_Request__desc;
  }
};

template <>
struct TopicTraits<ros2::ListParameters::Response> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__ListParameters_Response__desc;
  }
};

template <>
struct TopicTraits<ros2::GetParameters::Request> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__GetParameters_Request__desc;
  }
};

template <>
struct TopicTraits<ros2::GetParameters::Response> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__GetParameters_Response__desc;
  }
};

template <>
struct TopicTraits<ros2::GetParameterTypes::Request> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__GetParameterTypes_Request__desc;
  }
};

template <>
struct TopicTraits<ros2::GetParameterTypes::Response> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__GetParameterTypes_Response__desc;
  }
};

template <>
struct TopicTraits<ros2::DescribeParameters::Request> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__DescribeParameters_Request__desc;
  }
};

template <>
struct TopicTraits<ros2::DescribeParameters::Response> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__DescribeParameters_Response__desc;
  }
};

template <>
struct TopicTraits<ros2::SetParameters::Request> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__SetParameters_Request__desc;
  }
};

template <>
struct TopicTraits<ros2::SetParameters::Response> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__SetParameters_Response__desc;
  }
};

template <>
struct TopicTraits<ros2::SetParametersAtomically::Request> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__SetParametersAtomically_Request__desc;
  }
};

template <>
struct TopicTraits<ros2::SetParametersAtomically::Response> {
  static const dds_topic_descriptor_t& descriptor() {
    return rcl_interfaces_srv_dds__SetParametersAtomically_Response__desc;
  }
};

template <>
struct TopicTraits<ros2::Trigger::Request> {
  static const dds_topic_descriptor_t& descriptor() { return std_srvs_srv_dds__Trigger_Request__desc; }
};

template <>
struct TopicTraits<ros2::Trigger::Response> {
  static const dds_topic_descriptor_t& descriptor() { return std_srvs_srv_dds__Trigger_Response__desc; }
};

}  // namespace sonopose::dds
