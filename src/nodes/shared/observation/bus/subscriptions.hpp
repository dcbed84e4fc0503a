#pragma once
/// \file
/// Subscriptions to the watched topics.

#include "observation/bus/bus_watch.hpp"
#include "observation/own_reports.hpp"
#include "presence/instance_limit.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace sonopose::observation::bus {

/// Passes samples on to the hook.
template <class T>
class Listener : public ObservingListener<T> {
public:
  Listener(BeaconObservers& observers, process::EndpointCounters& endpoints, SampleHook* hook)
      : ObservingListener<T>(observers, endpoints), hook_(hook) {}

private:
  void on_sample(const typename ObservingListener<T>::Native& sample) noexcept override {
    if (hook_ != nullptr) hook_->on(sample);
  }

  SampleHook* hook_;
};

/// Time of taking samples.
enum class TakeTime : std::uint8_t {
  on_arrival,  ///< one by one in the receive threads, for the time of arrival
  in_batches   ///< by `take`, which costs less
};

/// A subscription to one topic.
template <class T>
struct Subscription {
  Subscription(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
               const dds::topics::Entry<T>& entry, BeaconObservers& observers,
               presence::BeaconAdmission& admission, process::EndpointCounters& endpoints, SampleHook* hook,
               TakeTime taking)
      : listener(observers, endpoints, hook),
        reader(dds::topics::make_reader(participant, qos, entry, &listener, dds::topics::Delivery::live,
                                        &admission, mask_of(taking))) {}

  /// Takes new samples.
  void take() { listener.on_data_available(reader); }

  Listener<T> listener;
  dds::sub::DataReader<T> reader;

private:
  static dds::core::status::StatusMask mask_of(TakeTime taking) {
    using Mask = dds::core::status::StatusMask;
    return taking == TakeTime::on_arrival ? Mask::all() : dds::ext::all_but(Mask::data_available());
  }
};

/// A subscription to a topic whose second key is a fusion. Taken in batches.
template <class T>
struct FusionSubscription {
  FusionSubscription(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                     const dds::topics::Entry<T>& entry, BeaconObservers& observers,
                     presence::BeaconAdmission& admission, process::EndpointCounters& endpoints,
                     SampleHook* hook)
      : limit(&admission),
        listener(observers, endpoints, hook, limit),
        reader(
            dds::topics::make_reader(participant, qos, entry, &listener, dds::topics::Delivery::live, &limit,
                                     dds::ext::all_but(dds::core::status::StatusMask::data_available()))) {}

  void take() { listener.on_data_available(reader); }

  class ForgettingListener final : public Listener<T> {
  public:
    ForgettingListener(BeaconObservers& observers, process::EndpointCounters& endpoints, SampleHook* hook,
                       presence::InstanceLimit<T>& limit)
        : Listener<T>(observers, endpoints, hook), limit_(limit) {}

  private:
    void on_gone(const T& key) noexcept override { limit_.forget(key); }

    presence::InstanceLimit<T>& limit_;
  };

  presence::InstanceLimit<T> limit;
  ForgettingListener listener;
  dds::sub::DataReader<T> reader;
};

/// A subscription to the reports of the fusion that owns the poses, without those of its standbys. Taken in
/// batches.
struct ReportSubscription {
  ReportSubscription(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                     BeaconObservers& observers, presence::BeaconAdmission& admission,
                     process::EndpointCounters& endpoints, SampleHook* hook,
                     const dds::sub::DataReader<sonopose_FusedPose>& poses)
      : listener(observers, endpoints, hook, poses),
        reader(dds::topics::make_reader(participant, qos, dds::topics::report, &listener,
                                        dds::topics::Delivery::live, &admission,
                                        dds::ext::all_but(dds::core::status::StatusMask::data_available()))) {
  }

  void take() { listener.on_data_available(reader); }

  class OwnListener final : public Listener<sonopose_FixReport> {
  public:
    OwnListener(BeaconObservers& observers, process::EndpointCounters& endpoints, SampleHook* hook,
                const dds::sub::DataReader<sonopose_FusedPose>& poses)
        : Listener<sonopose_FixReport>(observers, endpoints, hook), observers_(observers), poses_(poses) {}

  private:
    bool accepts(const dds::sub::DataReader<sonopose_FixReport>& reader, const FixReport& report,
                 const dds::sub::SampleInfo& info) noexcept override {
      return own_.accepts(report.address, reader, info.publication_handle(), poses_,
                          observers_.pose_writer_of(report.address));
    }

    BeaconObservers& observers_;
    const dds::sub::DataReader<sonopose_FusedPose>& poses_;
    OwnReports own_;
  };

  OwnListener listener;
  dds::sub::DataReader<sonopose_FixReport> reader;
};

/// All subscriptions. Poses are taken on arrival, because their latency is measured.
struct Subscriptions {
  Subscriptions(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                BeaconObservers& observers, presence::BeaconAdmission& admission,
                process::EndpointCounters& endpoints, SampleHook* hook, bool has_reports)
      : pose(participant, qos, dds::topics::pose, observers, admission, endpoints, hook,
             TakeTime::on_arrival),
        truth(participant, qos, dds::topics::truth, observers, admission, endpoints, hook,
              TakeTime::in_batches),
        beacon_status(participant, qos, dds::topics::beacon_status, observers, admission, endpoints, hook,
                      TakeTime::in_batches),
        estimate(participant, qos, dds::topics::estimate, observers, admission, endpoints, hook),
        fusion_status(participant, qos, dds::topics::fusion_status, observers, admission, endpoints, hook) {
    if (has_reports) {
      report.emplace(participant, qos, observers, admission, endpoints, hook, pose.reader);
    }
  }

  void take() {
    truth.take();
    beacon_status.take();
    estimate.take();
    fusion_status.take();
    if (report) report->take();
  }

  /// A message for the user, if instances were refused.
  std::optional<std::string> refusals() {
    auto text = fusion_status.limit.refusals();
    return text ? text : estimate.limit.refusals();
  }

  Subscription<sonopose_FusedPose> pose;
  Subscription<sonopose_TruthSample> truth;
  Subscription<sonopose_BeaconStatus> beacon_status;
  FusionSubscription<sonopose_Estimate> estimate;
  FusionSubscription<sonopose_FusionStatus> fusion_status;
  std::optional<ReportSubscription> report;
};

}  // namespace sonopose::observation::bus
