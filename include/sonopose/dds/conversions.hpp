#pragma once
/// \file
/// Hub struct ↔ IDL type, for every native topic. Pure functions. Units and frames are the same on both
/// sides; an empty optional is a validity flag on the wire (a negative number for a fix's quality, which is a
/// float there).

#include <sonopose/core/pose.hpp>
#include <sonopose/core/samples.hpp>
#include <sonopose/core/status.hpp>
#include <sonopose/idl/sonopose.h>

namespace sonopose::dds {

sonopose_ImuSample to_idl(const ImuSample& sample);
sonopose_UltrasonicFix to_idl(const UltrasonicFix& fix);
sonopose_PairHeading to_idl(const PairHeading& heading);
sonopose_FusedPose to_idl(const FusedPose& pose);
sonopose_FixReport to_idl(const FixReport& report);
sonopose_BeaconStatus to_idl(const BeaconStatus& status);
sonopose_FusionStatus to_idl(const FusionStatus& status);
sonopose_TruthSample to_idl(const TruthSample& truth);

ImuSample from_idl(const sonopose_ImuSample& sample);
UltrasonicFix from_idl(const sonopose_UltrasonicFix& fix);
PairHeading from_idl(const sonopose_PairHeading& heading);
FusedPose from_idl(const sonopose_FusedPose& pose);
FixReport from_idl(const sonopose_FixReport& report);
BeaconStatus from_idl(const sonopose_BeaconStatus& status);
FusionStatus from_idl(const sonopose_FusionStatus& status);
TruthSample from_idl(const sonopose_TruthSample& truth);

}  // namespace sonopose::dds
