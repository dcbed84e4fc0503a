#pragma once
/// \file
/// Conversions between native and IDL types, for every native topic. Pure functions. Units and frames are the
/// same on both sides. An empty optional is a validity flag on the wire, or a negative number for quantities
/// that are never negative.

#include <sonopose/idl/sonopose.h>
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/log_line.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace sonopose::dds::topics {

/// An IDL sample for writing, with a list of assignments that it owns.
template <class T>
class IdlView {
public:
  IdlView(const T& sample, std::vector<sonopose_SettingAssignment> list,
          dds_sequence_sonopose_SettingAssignment T::*field)
      : list_(std::move(list)), sample_(sample) {
    const auto length = static_cast<std::uint32_t>(list_.size());
    sample_.*field = {length, length, list_.data(), false};
  }
  IdlView(const IdlView&) = delete;
  IdlView& operator=(const IdlView&) = delete;
  IdlView(IdlView&&) noexcept = default;
  IdlView& operator=(IdlView&&) noexcept = default;
  ~IdlView() = default;

  [[nodiscard]] const T& sample() const { return sample_; }

private:
  std::vector<sonopose_SettingAssignment> list_;
  T sample_;
};

sonopose_ImuSample to_idl(const ImuSample& native);
sonopose_UltrasonicFix to_idl(const UltrasonicFix& native);
sonopose_PairHeading to_idl(const PairHeading& native);
sonopose_TwistSample to_idl(const TwistSample& native);
sonopose_StationaryBeacon to_idl(const StationaryBeacon& native);
sonopose_FusedPose to_idl(const FusedPose& native);
sonopose_FixReport to_idl(const FixReport& native);
sonopose_Estimate to_idl(const Estimate& native);
sonopose_BeaconStatus to_idl(const BeaconStatus& native);
sonopose_LineStatus to_idl(const LineStatus& native);
sonopose_FusionStatus to_idl(const FusionStatus& native);
sonopose_TruthSample to_idl(const TruthSample& native);
/// Texts that are too long end in "...".
sonopose_LogLine to_idl(const LogLine& native);
/// `reason` and `details` end in "..." if they are too long.
sonopose_SettingsReply to_idl(const SettingsReply& native);
/// Throws `std::length_error` if a key, a value or the list is too long for its type.
IdlView<sonopose_SettingsRequest> to_idl(const SettingsRequest& native);
/// Throws like the above. Settings published by the fusion always fit.
IdlView<sonopose_EffectiveSettings> to_idl(const EffectiveSettings& native);

ImuSample from_idl(const sonopose_ImuSample& idl);
UltrasonicFix from_idl(const sonopose_UltrasonicFix& idl);
PairHeading from_idl(const sonopose_PairHeading& idl);
TwistSample from_idl(const sonopose_TwistSample& idl);
StationaryBeacon from_idl(const sonopose_StationaryBeacon& idl);
FusedPose from_idl(const sonopose_FusedPose& idl);
FixReport from_idl(const sonopose_FixReport& idl);
Estimate from_idl(const sonopose_Estimate& idl);
BeaconStatus from_idl(const sonopose_BeaconStatus& idl);
LineStatus from_idl(const sonopose_LineStatus& idl);
FusionStatus from_idl(const sonopose_FusionStatus& idl);
TruthSample from_idl(const sonopose_TruthSample& idl);
LogLine from_idl(const sonopose_LogLine& idl);
SettingsRequest from_idl(const sonopose_SettingsRequest& idl);
SettingsReply from_idl(const sonopose_SettingsReply& idl);
EffectiveSettings from_idl(const sonopose_EffectiveSettings& idl);

}  // namespace sonopose::dds::topics
