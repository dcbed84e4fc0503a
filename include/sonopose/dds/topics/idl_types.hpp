#pragma once
/// \file
/// Descriptors of the native IDL types.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/idl/sonopose.h>

SONOPOSE_TOPIC_TYPE(sonopose_ImuSample)
SONOPOSE_TOPIC_TYPE(sonopose_UltrasonicFix)
SONOPOSE_TOPIC_TYPE(sonopose_PairHeading)
SONOPOSE_TOPIC_TYPE(sonopose_TwistSample)
SONOPOSE_TOPIC_TYPE(sonopose_StationaryBeacon)
SONOPOSE_TOPIC_TYPE(sonopose_FusedPose)
SONOPOSE_TOPIC_TYPE(sonopose_FixReport)
SONOPOSE_TOPIC_TYPE(sonopose_Estimate)
SONOPOSE_TOPIC_TYPE(sonopose_BeaconStatus)
SONOPOSE_TOPIC_TYPE(sonopose_LineStatus)
SONOPOSE_TOPIC_TYPE(sonopose_FusionStatus)
SONOPOSE_TOPIC_TYPE(sonopose_TruthSample)
SONOPOSE_TOPIC_TYPE(sonopose_ResetCommand)
SONOPOSE_TOPIC_TYPE(sonopose_SettingsRequest)
SONOPOSE_TOPIC_TYPE(sonopose_SettingsReply)
SONOPOSE_TOPIC_TYPE(sonopose_EffectiveSettings)
SONOPOSE_TOPIC_TYPE(sonopose_LogLine)
