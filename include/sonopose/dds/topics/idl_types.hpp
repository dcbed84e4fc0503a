#pragma once
/// \file
/// Descriptors of the native IDL types.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/idl/sonopose.h>

namespace sonopose::dds {

template <>
struct TopicTraits<sonopose_ImuSample> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_ImuSample_desc; }
};

template <>
struct TopicTraits<sonopose_UltrasonicFix> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_UltrasonicFix_desc; }
};

template <>
struct TopicTraits<sonopose_PairHeading> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_PairHeading_desc; }
};

template <>
struct TopicTraits<sonopose_TwistSample> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_TwistSample_desc; }
};

template <>
struct TopicTraits<sonopose_StationaryBeacon> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_StationaryBeacon_desc; }
};

template <>
struct TopicTraits<sonopose_FusedPose> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_FusedPose_desc; }
};

template <>
struct TopicTraits<sonopose_FixReport> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_FixReport_desc; }
};

template <>
struct TopicTraits<sonopose_Estimate> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_Estimate_desc; }
};

template <>
struct TopicTraits<sonopose_BeaconStatus> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_BeaconStatus_desc; }
};

template <>
struct TopicTraits<sonopose_LineStatus> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_LineStatus_desc; }
};

template <>
struct TopicTraits<sonopose_FusionStatus> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_FusionStatus_desc; }
};

template <>
struct TopicTraits<sonopose_TruthSample> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_TruthSample_desc; }
};

template <>
struct TopicTraits<sonopose_ResetCommand> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_ResetCommand_desc; }
};

template <>
struct TopicTraits<sonopose_SettingsRequest> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_SettingsRequest_desc; }
};

template <>
struct TopicTraits<sonopose_SettingsReply> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_SettingsReply_desc; }
};

template <>
struct TopicTraits<sonopose_EffectiveSettings> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_EffectiveSettings_desc; }
};

template <>
struct TopicTraits<sonopose_LogLine> {
  static const dds_topic_descriptor_t& descriptor() { return sonopose_LogLine_desc; }
};

}  // namespace sonopose::dds
