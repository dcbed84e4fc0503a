#pragma once
/// \file
/// Subscriptions to the watched topics.

#include "observation/bus/bus_watch.hpp"
#include "observation/own_reports.hpp"
#include "presence/instance_limit.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <optional>
#include <string>

namespace sonopose::observation::bus {

/// Objects that all subscriptions use, and that must outlive them.
struct Watch {
  const dds::domain::DomainParticipant& participant;
  const dds::qos::Provider& qos;
  BeaconObservers& observers;
  presence::BeaconAdmission& admission;
  process::EndpointCounters& endpoints;
  SampleHook* hook;
};

/// Passes samples on to the hook.
template <class T>
class Listener : public ObservingListener<T> {
public:
  explicit Listener(const Watch& watch)
      : ObservingListener<T>(watch.observers, watch.endpoints), hook_(watch.hook) {}

private:
  void on_sample(const typename ObservingListener<T>::Native& sample) noexcept override {
    if (hook_ != nullptr) hook_->on(sample);
  }

  SampleHook* hook_;
};

/// Forgets the instances of a topic whose second key is a fusion.
template <class T>
class ForgettingListener final : public Listener<T> {
public:
  ForgettingListener(const Watch& watch, presence::InstanceLimit<T>& limit)
      : Listener<T>(watch), limit_(limit) {}

private:
  void on_gone(const T& key) noexcept override { limit_.forget(key); }

  presence::InstanceLimit<T>& limit_;
};

/// Ignores the reports of standbys of the fusion that owns the poses.
class OwnReportListener final : public Listener<sonopose_FixReport> {
public:
  OwnReportListener(const Watch& watch, const dds::sub::DataReader<sonopose_FusedPose>& poses)
      : Listener<sonopose_FixReport>(watch), observers_(watch.observers), poses_(poses) {}

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

/// A subscription to one topic.
template <class T, class L = Listener<T>>
struct Subscription {
  /// `statuses`: those of the listener. Without data_available, `take` takes the samples, in batches, which
  /// costs less.
  Subscription(const Watch& watch, const dds::topics::Entry<T>& entry, auto& filter,
               const dds::core::status::StatusMask& statuses, auto&... of_listener)
      : listener(watch, of_listener...),
        reader(dds::topics::make_reader(watch.participant, watch.qos, entry, &listener,
                                        dds::topics::Delivery::live, &filter, statuses)) {}

  /// Takes new samples.
  void take() { listener.on_data_available(reader); }

  L listener;
  dds::sub::DataReader<T> reader;
};

/// All subscriptions. Poses are taken on arrival, because their latency is measured.
struct Subscriptions {
  Subscriptions(const Watch& watch, bool has_reports)
      : estimate_limit(&watch.admission),
        fusion_status_limit(&watch.admission),
        pose(watch, dds::topics::pose, watch.admission, dds::core::status::StatusMask::all()),
        truth(watch, dds::topics::truth, watch.admission, in_batches()),
        beacon_status(watch, dds::topics::beacon_status, watch.admission, in_batches()),
        estimate(watch, dds::topics::estimate, estimate_limit, in_batches(), estimate_limit),
        fusion_status(watch, dds::topics::fusion_status, fusion_status_limit, in_batches(),
                      fusion_status_limit) {
    if (has_reports) report.emplace(watch, dds::topics::report, watch.admission, in_batches(), pose.reader);
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
    auto text = fusion_status_limit.refusals();
    return text ? text : estimate_limit.refusals();
  }

  presence::InstanceLimit<sonopose_Estimate> estimate_limit;
  presence::InstanceLimit<sonopose_FusionStatus> fusion_status_limit;
  Subscription<sonopose_FusedPose> pose;
  Subscription<sonopose_TruthSample> truth;
  Subscription<sonopose_BeaconStatus> beacon_status;
  Subscription<sonopose_Estimate, ForgettingListener<sonopose_Estimate>> estimate;
  Subscription<sonopose_FusionStatus, ForgettingListener<sonopose_FusionStatus>> fusion_status;
  std::optional<Subscription<sonopose_FixReport, OwnReportListener>> report;

private:
  static dds::core::status::StatusMask in_batches() {
    return dds::ext::all_but(dds::core::status::StatusMask::data_available());
  }
};

}  // namespace sonopose::observation::bus
