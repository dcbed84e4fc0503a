#pragma once
/// \file
/// Receives the native topics of the bus: from a sample in a DDS reader to the publishers of its beacon.

#include "observation/beacon_observers.hpp"
#include "presence/beacon_admission.hpp"
#include "presence/instance_limit.hpp"
#include "process/endpoint_counters.hpp"
#include "ros2/relay/autopilot_output.hpp"
#include "ros2/relay/relay.hpp"
#include "ros2/relay/relayed_beacons.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <array>
#include <map>
#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Takes samples on Cyclone's receive threads. Its functions are for the main thread only.
class NativeReceiver {
public:
  /// Recipients of samples and statuses. All must outlive the receiver.
  struct Targets {
    RelayedBeacons& beacons;
    observation::BeaconObservers& observers;  ///< for diagnostics
    process::EndpointCounters& endpoints;
    AutopilotOutput* autopilot;  ///< null: none
  };

  /// Starts receiving. `admission` must outlive the receiver. Throws dds::core::Exception.
  NativeReceiver(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                 const RelayOptions& options, presence::BeaconAdmission& admission, const Targets& targets);
  NativeReceiver(const NativeReceiver&) = delete;
  NativeReceiver& operator=(const NativeReceiver&) = delete;
  ~NativeReceiver();

  /// Gives new publishers of a beacon the fusion's setting, if it arrived before them.
  void assign_fix_std_to(BeaconPublishers& publishers, BeaconAddress address);

  /// Messages for the user about refused beacons and fusions. Call it once a second.
  std::array<std::optional<std::string>, 3> refusals() {
    return {admission_.refusals(), fusion_limit_.refusals(), estimate_limit_.refusals()};
  }

  /// Presence of a process that publishes samples, and of one that publishes poses.
  [[nodiscard]] bool has_bridge() { return imu_.has_writer(); }
  [[nodiscard]] bool has_fusion() { return pose_.has_writer(); }

private:
  /// Passes samples of one topic to the publishers of their beacon.
  template <class T>
  class PublishingListener final : public process::CountingReaderListener<T> {
  public:
    explicit PublishingListener(NativeReceiver& receiver)
        : process::CountingReaderListener<T>(receiver.targets_.endpoints), receiver_(receiver) {}
    void on_data_available(dds::sub::DataReader<T>& reader) noexcept override { receiver_.take(reader); }

  private:
    NativeReceiver& receiver_;
  };

  /// Passes samples of one topic to the observers too.
  template <class T>
  class DiagnosticListener final : public observation::ObservingListener<T> {
  public:
    using Base = observation::ObservingListener<T>;
    explicit DiagnosticListener(NativeReceiver& receiver)
        : Base(receiver.targets_.observers, receiver.targets_.endpoints), receiver_(receiver) {}

  private:
    void on_sample(const typename Base::Native& sample) noexcept override { receiver_.on(sample); }
    void on_gone(const T& key) noexcept override { receiver_.on_gone(key); }

    NativeReceiver& receiver_;
  };

  /// A topic: its listener and its reader.
  template <class T, template <class> class Listener>
  struct Subscription {
    explicit Subscription(NativeReceiver& receiver) : listener(receiver) {}
    [[nodiscard]] bool has_writer() { return reader.subscription_matched_status().current_count() > 0; }
    Listener<T> listener;
    dds::sub::DataReader<T> reader = dds::core::null;
  };

  template <class T>
  void take(dds::sub::DataReader<T>& reader);
  template <class Sample>
  void on(const Sample& sample);
  void on(const FusedPose& pose);
  void on(const Estimate& estimate);
  void on(const EffectiveSettings& settings);
  void on(const BeaconStatus& /*status*/) {}
  void on(const FusionStatus& /*status*/) {}
  void on_gone(const sonopose_FusionStatus& key) { fusion_limit_.forget(key); }
  void on_gone(const sonopose_Estimate& key) { estimate_limit_.forget(key); }
  void on_gone(const auto& /*key*/) {}

  Targets targets_;
  presence::BeaconAdmission& admission_;
  presence::AdmittedOnly admitted_only_{admission_};
  presence::InstanceLimit<sonopose_FusionStatus> fusion_limit_{&admitted_only_};
  presence::InstanceLimit<sonopose_Estimate> estimate_limit_{&admitted_only_};
  presence::BeaconAdmission settings_admission_;  ///< settings may arrive before any sample, and only once

  threads::Mutex mutex_;
  std::map<BeaconAddress, double> fix_stds_m_ SONOPOSE_GUARDED_BY(mutex_);  ///< settings of the fusion

  // Readers last: their listeners may be called before the constructor ends.
  Subscription<sonopose_ImuSample, PublishingListener> imu_{*this};
  Subscription<sonopose_UltrasonicFix, PublishingListener> fix_{*this};
  Subscription<sonopose_FusedPose, DiagnosticListener> pose_{*this};
  Subscription<sonopose_FixReport, PublishingListener> report_{*this};
  Subscription<sonopose_EffectiveSettings, PublishingListener> settings_{*this};
  Subscription<sonopose_Estimate, PublishingListener> estimate_{*this};
  Subscription<sonopose_BeaconStatus, DiagnosticListener> beacon_status_{*this};
  Subscription<sonopose_FusionStatus, DiagnosticListener> fusion_status_{*this};
};

}  // namespace sonopose::ros2::relay
