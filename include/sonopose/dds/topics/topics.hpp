#pragma once
/// \file
/// The wiring diagram: every native topic with its type and the QoS profiles of its endpoints.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <tuple>
#include <type_traits>

namespace sonopose::dds::topics {

/// One row: a topic's name, type and profiles (of `qos/sonopose.xml`).
template <class T>
struct Entry {
  using Type = T;
  const char* name;
  const char* profile;           ///< profile for live use
  const char* lossless_profile;  ///< profile for replaying a log at full speed; the live one if it suffices
};

/// bridge → fusion, recorder
inline constexpr Entry<sonopose_ImuSample> imu{"sonopose/imu", "sonopose::Imu", "sonopose::LosslessImu"};
inline constexpr Entry<sonopose_UltrasonicFix> fix{"sonopose/fix", "sonopose::Fix", "sonopose::LosslessFix"};
inline constexpr Entry<sonopose_PairHeading> heading{"sonopose/heading", "sonopose::Heading",
                                                     "sonopose::LosslessHeading"};
/// wheel odometry → fusion
inline constexpr Entry<sonopose_TwistSample> twist{"sonopose/twist", "sonopose::Twist",
                                                   "sonopose::LosslessTwist"};
/// bridge → consumers
inline constexpr Entry<sonopose_StationaryBeacon> stationary_beacon{
    "sonopose/stationary_beacon", "sonopose::StationaryBeacon", "sonopose::StationaryBeacon"};
/// fusion → consumers
inline constexpr Entry<sonopose_FusedPose> pose{"sonopose/pose", "sonopose::Pose", "sonopose::LosslessPose"};
inline constexpr Entry<sonopose_FixReport> report{"sonopose/report", "sonopose::Report",
                                                  "sonopose::LosslessReport"};
inline constexpr Entry<sonopose_Estimate> estimate{"sonopose/estimate", "sonopose::Status",
                                                   "sonopose::Status"};
/// bridge, fusion → monitor
inline constexpr Entry<sonopose_LineStatus> line_status{"sonopose/line_status", "sonopose::Status",
                                                        "sonopose::Status"};
inline constexpr Entry<sonopose_BeaconStatus> beacon_status{"sonopose/beacon_status", "sonopose::Status",
                                                            "sonopose::Status"};
inline constexpr Entry<sonopose_FusionStatus> fusion_status{"sonopose/fusion_status", "sonopose::Status",
                                                            "sonopose::Status"};
/// simulator → monitor, scoring
inline constexpr Entry<sonopose_TruthSample> truth{"sonopose/truth", "sonopose::Truth", "sonopose::Truth"};
/// any program → fusion
inline constexpr Entry<sonopose_ResetCommand> reset{"sonopose/reset", "sonopose::Command",
                                                    "sonopose::Command"};
inline constexpr Entry<sonopose_SettingsRequest> settings_request{
    "sonopose/settings_request", "sonopose::SettingsRequest", "sonopose::SettingsRequest"};
/// fusion → the requesting program
inline constexpr Entry<sonopose_SettingsReply> settings_reply{
    "sonopose/settings_reply", "sonopose::SettingsReply", "sonopose::SettingsReply"};
/// fusion → any program
inline constexpr Entry<sonopose_EffectiveSettings> settings{"sonopose/settings", "sonopose::Settings",
                                                            "sonopose::Settings"};
/// fusion → any program that saves them
inline constexpr Entry<sonopose_EffectiveSettings> changed_settings{
    "sonopose/changed_settings", "sonopose::Settings", "sonopose::Settings"};
/// bridge, fusion, relay → web page, any program
inline constexpr Entry<sonopose_LogLine> log{"sonopose/log", "sonopose::Log", "sonopose::Log"};

/// All rows.
inline constexpr std::tuple all{imu,
                                fix,
                                heading,
                                twist,
                                stationary_beacon,
                                pose,
                                report,
                                estimate,
                                line_status,
                                beacon_status,
                                fusion_status,
                                truth,
                                reset,
                                settings_request,
                                settings_reply,
                                settings,
                                log,
                                changed_settings};

enum class Delivery : bool { live, lossless };

template <class T>
const char* profile_of(const Entry<T>& entry, Delivery delivery) {
  return delivery == Delivery::lossless ? entry.lossless_profile : entry.profile;
}

/// True if only the strongest writer of an instance is heard.
inline bool is_exclusive(const Qos& qos) {
  return qos.policy_or_default<policy::Ownership>().kind() == policy::OwnershipKind::EXCLUSIVE;
}

/// Decides which beacons a process receives, before DDS keeps anything of them. Called on receive threads.
class AddressFilter {
public:
  AddressFilter() = default;
  AddressFilter(const AddressFilter&) = delete;
  AddressFilter& operator=(const AddressFilter&) = delete;
  virtual ~AddressFilter() = default;
  virtual bool accepts(BeaconAddress address) noexcept = 0;
};

/// Makes a writer for one row of the diagram. `listener` must outlive it. `changes` override the profile.
template <class T>
pub::DataWriter<T> make_writer(const domain::DomainParticipant& participant, const qos::Provider& qos,
                               const Entry<T>& entry,
                               std::type_identity_t<pub::DataWriterListener<T>>* listener = nullptr,
                               Delivery delivery = Delivery::live, const Qos& changes = {}) {
  const char* profile = profile_of(entry, delivery);
  const topic::Topic<T> topic(participant, entry.name, qos.topic_qos(profile));
  Qos writer_qos = qos.datawriter_qos(profile);
  writer_qos.merge(changes);
  return pub::DataWriter<T>(ext::publisher_of(participant, writer_qos), topic, writer_qos, listener,
                            core::status::StatusMask::all());
}

/// Makes a reader for one row of the diagram. `listener` and `filter` must outlive it. The listener receives
/// the statuses in `mask`, but no losses of an exclusive reader: DDS counts what weaker writers, such as a
/// standby, write. `filter` is an AddressFilter, or accepts whole samples. `changes` override the profile.
template <class T, class Filter = AddressFilter>
sub::DataReader<T> make_reader(const domain::DomainParticipant& participant, const qos::Provider& qos,
                               const Entry<T>& entry,
                               std::type_identity_t<sub::DataReaderListener<T>>* listener = nullptr,
                               Delivery delivery = Delivery::live, Filter* filter = nullptr,
                               core::status::StatusMask mask = core::status::StatusMask::all(),
                               const Qos& changes = {}) {
  const char* profile = profile_of(entry, delivery);
  const topic::Topic<T> topic(participant, entry.name, qos.topic_qos(profile));
  if constexpr (requires(const T& sample) { filter->accepts(sample); }) {
    const auto accepts = [](const void* sample, void* argument) {
      return static_cast<Filter*>(argument)->accepts(*static_cast<const T*>(sample));
    };
    if (filter != nullptr) ext::set_filter(topic, accepts, filter);
  } else if constexpr (requires(const T& sample) { filter->accepts(sample.address); }) {
    const auto accepts = [](const void* sample, void* argument) {
      return static_cast<Filter*>(argument)->accepts(static_cast<const T*>(sample)->address);
    };
    if (filter != nullptr) ext::set_filter(topic, accepts, filter);
  }
  Qos reader_qos = qos.datareader_qos(profile);
  reader_qos.merge(changes);
  if (is_exclusive(reader_qos)) mask &= ~core::status::StatusMask::sample_lost();
  return sub::DataReader<T>(ext::subscriber_of(participant, reader_qos), topic, reader_qos, listener, mask);
}

}  // namespace sonopose::dds::topics
