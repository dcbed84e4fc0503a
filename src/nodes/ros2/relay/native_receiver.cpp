#include "ros2/relay/native_receiver.hpp"

#include "clocks/clocks.hpp"
#include "ros2/relay/beacon_publishers.hpp"
#include <sonopose/dds/topics/conversions.hpp>

namespace sonopose::ros2::relay {

NativeReceiver::NativeReceiver(const dds::domain::DomainParticipant& participant,
                               const dds::qos::Provider& qos, const RelayOptions& options,
                               presence::BeaconAdmission& admission, const Targets& targets)
    : targets_(targets),
      admission_(admission),
      settings_admission_(options.addresses,
                          options.max_beacons * presence::BeaconAdmission::max_replacements) {
  namespace topics = dds::topics;
  const auto subscribe = [&](auto& subscription, const auto& topic, auto& filter) {
    subscription.reader =
        topics::make_reader(participant, qos, topic, &subscription.listener, topics::Delivery::live, &filter);
  };
  subscribe(imu_, topics::imu, admission_);
  subscribe(fix_, topics::fix, admission_);
  subscribe(pose_, topics::pose, admission_);
  subscribe(report_, topics::report, admission_);
  subscribe(settings_, topics::settings, settings_admission_);
  subscribe(estimate_, topics::estimate, estimate_limit_);
  subscribe(beacon_status_, topics::beacon_status, admitted_only_);
  subscribe(fusion_status_, topics::fusion_status, fusion_limit_);
}

NativeReceiver::~NativeReceiver() = default;

template <class T>
void NativeReceiver::take(dds::sub::DataReader<T>& reader) {
  dds::ext::try_take_each(
      reader,
      [this](const T& sample, const dds::sub::SampleInfo& info) {
        on(dds::topics::from_idl(sample));
        if (!dds::ext::is_alive(info)) on_gone(sample);
      },
      [this](const T& key, const dds::sub::SampleInfo& info) {
        if (!dds::ext::is_alive(info)) on_gone(key);
      });
}

/// Passes on samples, fixes and reports.
template <class Sample>
void NativeReceiver::on(const Sample& sample) {
  const auto publishers = targets_.beacons.find_or_request(sample.address, clocks::steady_now());
  if (publishers) publishers->on(sample);
}

void NativeReceiver::on(const FusedPose& pose) {
  const auto publishers = targets_.beacons.find_or_request(pose.address, clocks::steady_now());
  if (!publishers) return;
  publishers->on(pose);
  if (targets_.autopilot != nullptr) targets_.autopilot->on(pose, publishers->mount());
}

void NativeReceiver::on(const Estimate& estimate) {
  if (const auto publishers = targets_.beacons.find(estimate.address)) publishers->on(estimate);
}

void NativeReceiver::on(const EffectiveSettings& settings) {
  const double fix_std_m = fix_std_of(settings);
  {
    const threads::Lock lock(mutex_);
    fix_stds_m_[settings.address] = fix_std_m;
  }
  if (const auto publishers = targets_.beacons.find(settings.address)) publishers->set_fix_std(fix_std_m);
}

/// Keeps the lock, so that a setting that arrives meanwhile is assigned last.
void NativeReceiver::assign_fix_std_to(BeaconPublishers& publishers, BeaconAddress address) {
  const threads::Lock lock(mutex_);
  const auto known = fix_stds_m_.find(address);
  if (known != fix_stds_m_.end()) publishers.set_fix_std(known->second);
}

}  // namespace sonopose::ros2::relay
