#pragma once
/// \file
/// Native struct ↔ IDL type, for every native topic. Pure functions. Units and frames are the same on both
/// sides; an empty optional is a validity flag on the wire (a negative number for a fix's quality, which is a
/// float there).

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>
#include <sonopose/idl/sonopose.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace sonopose::dds {

/// An IDL sample with texts, for writing: its pointers lead into the native struct that it was made from, which
/// must outlive it.
template <class T>
class IdlView {
public:
  /// `list` is where the sample's list of assignments stands, if it has one.
  explicit IdlView(const T& sample, std::vector<sonopose_SettingAssignment> list = {},
                   dds_sequence_sonopose_SettingAssignment T::*field = nullptr)
      : list_(std::move(list)), sample_(sample) {
    if (field == nullptr) return;
    const auto length = static_cast<std::uint32_t>(list_.size());
    sample_.*field = {length, length, list_.data(), false};
  }
  IdlView(const IdlView&) = delete;
  IdlView& operator=(const IdlView&) = delete;
  IdlView(IdlView&&) = default;
  IdlView& operator=(IdlView&&) = default;
  ~IdlView() = default;

  [[nodiscard]] const T& sample() const { return sample_; }

private:
  std::vector<sonopose_SettingAssignment> list_;
  T sample_;
};

sonopose_ImuSample to_idl(const ImuSample& sample);
sonopose_UltrasonicFix to_idl(const UltrasonicFix& fix);
sonopose_PairHeading to_idl(const PairHeading& heading);
sonopose_FusedPose to_idl(const FusedPose& pose);
sonopose_FixReport to_idl(const FixReport& report);
sonopose_BeaconStatus to_idl(const BeaconStatus& status);
sonopose_FusionStatus to_idl(const FusionStatus& status);
sonopose_TruthSample to_idl(const TruthSample& truth);
IdlView<sonopose_SettingsRequest> to_idl(const SettingsRequest& request);
IdlView<sonopose_SettingsReply> to_idl(const SettingsReply& reply);
IdlView<sonopose_EffectiveSettings> to_idl(const EffectiveSettings& settings);

ImuSample from_idl(const sonopose_ImuSample& sample);
UltrasonicFix from_idl(const sonopose_UltrasonicFix& fix);
PairHeading from_idl(const sonopose_PairHeading& heading);
FusedPose from_idl(const sonopose_FusedPose& pose);
FixReport from_idl(const sonopose_FixReport& report);
BeaconStatus from_idl(const sonopose_BeaconStatus& status);
FusionStatus from_idl(const sonopose_FusionStatus& status);
TruthSample from_idl(const sonopose_TruthSample& truth);
SettingsRequest from_idl(const sonopose_SettingsRequest& request);
SettingsReply from_idl(const sonopose_SettingsReply& reply);
EffectiveSettings from_idl(const sonopose_EffectiveSettings& settings);

}  // namespace sonopose::dds
