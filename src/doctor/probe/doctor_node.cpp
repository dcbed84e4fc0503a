#include "doctor/probe/doctor_node.hpp"

#include "doctor/probe/beacon_probe.hpp"
#include "doctor/probe/survey.hpp"
#include "doctor/rules/rules.hpp"
#include "process/clocks.hpp"
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

namespace sonopose::doctor {
namespace {

namespace topics = dds::topics;

/// One topic that the doctor listens to.
template <class T>
struct Heard {
  Heard(const dds::DomainParticipant& participant, const dds::QosProvider& qos,
        const dds::TopicEntry<T>& entry)
      : reader(dds::make_reader(participant, qos, entry)), has_data(reader) {}

  dds::DataReader<T> reader;
  dds::ReadCondition has_data;
};

class Observer {
public:
  explicit Observer(const DoctorOptions& options);

  Observations run(const process::StopSignal& stop);

private:
  void listen_until(SteadyTime end, const process::StopSignal& stop);
  void take_all();
  template <class T>
  void take(Heard<T>& heard);
  template <class T>
  [[nodiscard]] double deadline_s(const dds::TopicEntry<T>& entry) const;
  /// Of these writers of IMU samples, those that are still there.
  [[nodiscard]] std::vector<ProcessObservation> processes_of(const std::set<std::uint64_t>& imu_writers,
                                                             const doctor::Processes& processes);
  [[nodiscard]] BeaconObservation seen_of(BeaconAddress address, const BeaconProbe& probe, TimeNs now_ns,
                                          const doctor::Processes& processes);

  const DoctorOptions& options_;
  dds::QosProvider qos_;
  dds::DomainParticipant participant_;
  dds::Discovery discovery_;
  Heard<sonopose_ImuSample> imu_;
  Heard<sonopose_UltrasonicFix> fix_;
  Heard<sonopose_PairHeading> heading_;
  Heard<sonopose_FusedPose> pose_;
  Heard<sonopose_BeaconStatus> beacon_status_;
  Heard<sonopose_FusionStatus> fusion_status_;
  Heard<sonopose_EffectiveSettings> settings_;
  dds::WaitSet waitset_;
  std::map<BeaconAddress, BeaconProbe> probes_;
  std::map<BeaconAddress, EffectiveSettings> settings_in_force_;
  TimeNs began_ns_ = 0;
};

Observer::Observer(const DoctorOptions& options)
    : options_(options),
      qos_(options.qos_file),
      participant_(options.domain),
      discovery_(participant_),
      imu_(participant_, qos_, topics::imu),
      fix_(participant_, qos_, topics::fix),
      heading_(participant_, qos_, topics::heading),
      pose_(participant_, qos_, topics::pose),
      beacon_status_(participant_, qos_, topics::beacon_status),
      fusion_status_(participant_, qos_, topics::fusion_status),
      settings_(participant_, qos_, topics::settings) {
  for (const dds::ReadCondition* const condition :
       {&imu_.has_data, &fix_.has_data, &heading_.has_data, &pose_.has_data, &beacon_status_.has_data,
        &fusion_status_.has_data, &settings_.has_data}) {
    waitset_ += *condition;
  }
}

template <class T>
void Observer::take(Heard<T>& heard) {
  const TimeNs received_ns = process::host_now();
  heard.reader.take_each([&](const T& sample, const dds::SampleInfo& info) {
    auto value = dds::from_idl(sample);
    if constexpr (std::is_same_v<T, sonopose_EffectiveSettings>) {
      settings_in_force_[value.address] = std::move(value);
    } else {
      const auto [entry, is_new] = probes_.try_emplace(value.address);
      BeaconProbe& probe = entry->second;
      if (is_new && began_ns_ != 0) probe.begin(began_ns_);
      if constexpr (std::is_same_v<T, sonopose_ImuSample>) {
        probe.on(value, received_ns, info.publication_handle().value);
      } else if constexpr (std::is_same_v<T, sonopose_BeaconStatus> ||
                           std::is_same_v<T, sonopose_FusionStatus>) {
        probe.on(value);
      } else {
        probe.on(value, received_ns);
      }
    }
  });
}

void Observer::take_all() {
  take(imu_);
  take(fix_);
  take(heading_);
  take(pose_);
  take(beacon_status_);
  take(fusion_status_);
  take(settings_);
}

void Observer::listen_until(SteadyTime end, const process::StopSignal& stop) {
  constexpr std::chrono::milliseconds look_period(20);
  while (process::steady_now() < end && !stop.requested()) {
    waitset_.wait(std::min<dds::Duration>(look_period, dds::Duration(end - process::steady_now())));
    take_all();
  }
}

template <class T>
double Observer::deadline_s(const dds::TopicEntry<T>& entry) const {
  const dds::Duration deadline = dds::deadline_of(qos_.datareader_qos(entry.profile));
  if (deadline == dds::infinite) return std::numeric_limits<double>::infinity();
  return std::chrono::duration<double>(deadline).count();
}

std::vector<ProcessObservation> Observer::processes_of(const std::set<std::uint64_t>& imu_writers,
                                                       const doctor::Processes& processes) {
  std::vector<ProcessObservation> found;
  const auto there = imu_.reader.matched_publications();
  for (const std::uint64_t writer : imu_writers) {
    if (std::find(there.begin(), there.end(), dds::InstanceHandle{writer}) == there.end()) continue;
    try {
      const auto key = dds::text_of(imu_.reader.matched_publication_data({writer}).participant_key);
      found.push_back(doctor::process_of(processes, key));
    } catch (const dds::Error&) {
      continue;  // it has left just now
    }
  }
  return found;
}

BeaconObservation Observer::seen_of(BeaconAddress address, const BeaconProbe& probe, TimeNs now_ns,
                                    const doctor::Processes& processes) {
  auto settings = settings_in_force_.find(address);
  if (settings == settings_in_force_.end()) settings = settings_in_force_.find(all_beacons);
  BeaconObservation seen =
      probe.seen(now_ns, settings == settings_in_force_.end() ? calibration::Settings{}
                                                              : calibration_in(settings->second));
  seen.address = address;
  seen.imu.deadline_s = deadline_s(topics::imu);
  seen.fix.deadline_s = deadline_s(topics::fix);
  seen.heading.deadline_s = deadline_s(topics::heading);
  seen.pose.deadline_s = deadline_s(topics::pose);
  seen.bridges = processes_of(probe.writers(), processes);
  return seen;
}

Observations Observer::run(const process::StopSignal& stop) {
  // Long enough for everybody to be found, also over a network.
  constexpr TimeNs settling_ns = 500'000'000;
  listen_until(process::steady_now() + settling_ns, stop);
  began_ns_ = process::host_now();
  for (auto& entry : probes_) entry.second.begin(began_ns_);
  listen_until(process::steady_now() + to_ns(options_.duration_s), stop);
  const TimeNs ended_ns = process::host_now();

  const doctor::Processes processes = doctor::processes_in(discovery_.participants());
  const std::string own_key = discovery_.own_key();
  Observations seen;
  seen.window_s = seconds_between(began_ns_, ended_ns);
  seen.bus = doctor::bus_of(options_.domain);
  seen.own_host = doctor::process_of(processes, own_key).host;
  seen.native_topics = doctor::native_topics();
  seen.writers = doctor::others_of(discovery_.writers(), processes, own_key);
  seen.readers = doctor::others_of(discovery_.readers(), processes, own_key);
  for (const auto& [address, probe] : probes_) {
    seen.beacons.push_back(seen_of(address, probe, ended_ns, processes));
  }
  return seen;
}

}  // namespace

Observations observe(const DoctorOptions& options, const process::StopSignal& stop) {
  Observations seen = Observer(options).run(stop);
  if (doctor::on_topic(seen.writers, topics::imu.name).empty() ||
      doctor::on_topic(seen.writers, topics::pose.name).empty()) {
    seen.bus.looked_elsewhere = true;
    seen.bus.other_domains = doctor::look_elsewhere(options.domain, stop);
  }
  return seen;
}

}  // namespace sonopose::doctor
