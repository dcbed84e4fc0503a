#include "doctor/probe/doctor_node.hpp"

#include "clocks/clocks.hpp"
#include "doctor/probe/beacon_probe.hpp"
#include "doctor/probe/survey.hpp"
#include "process/instance_limit.hpp"
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sonopose::doctor::probe {
namespace {

namespace topics = dds::topics;

/// A subscription to one topic. It keeps all samples until they are taken: those that a pause of the doctor
/// would make it lose look like losses of the system.
template <class T>
struct Subscription {
  template <class Filter = dds::topics::AddressFilter>
  Subscription(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
               const dds::topics::Entry<T>& entry, Filter* filter = nullptr)
      : reader(dds::topics::make_reader(participant, qos, entry, nullptr, dds::topics::Delivery::lossless,
                                        filter)),
        has_data(reader) {}

  dds::DataReader<T> reader;
  dds::ReadCondition has_data;
};

class SystemObserver {
public:
  explicit SystemObserver(const DoctorOptions& options);

  rules::Observations run(const process::StopSignal& stop);

private:
  void listen_until(SteadyTime end, const process::StopSignal& stop);
  void listen_for_window(const process::StopSignal& stop);
  [[nodiscard]] bool is_alone();
  void take_all();
  template <class T>
  void take(Subscription<T>& subscription);
  template <class T>
  [[nodiscard]] double deadline_s(const dds::topics::Entry<T>& entry) const;
  /// The processes of those of these IMU writers that still exist.
  [[nodiscard]] std::vector<rules::ProcessObservation> processes_of(
      const std::set<std::uint64_t>& imu_writers, const Processes& processes);
  [[nodiscard]] rules::BeaconObservation observation_of(BeaconAddress address, const BeaconProbe& probe,
                                                        TimeNs now_ns, const process::StopSignal& stop);

  const DoctorOptions& options_;
  dds::qos::Provider qos_;
  dds::DomainParticipant participant_;
  dds::Discovery discovery_;
  process::BeaconAdmission admission_;
  process::InstanceLimit<sonopose_LineStatus> line_limit_;
  process::InstanceLimit<sonopose_FusionStatus> fusion_limit_;
  Subscription<sonopose_ImuSample> imu_;
  Subscription<sonopose_UltrasonicFix> fix_;
  Subscription<sonopose_PairHeading> heading_;
  Subscription<sonopose_FusedPose> pose_;
  Subscription<sonopose_FixReport> report_;
  Subscription<sonopose_BeaconStatus> beacon_status_;
  Subscription<sonopose_LineStatus> line_status_;
  Subscription<sonopose_FusionStatus> fusion_status_;
  Subscription<sonopose_EffectiveSettings> settings_;
  dds::WaitSet waitset_;
  std::map<BeaconAddress, BeaconProbe> probes_;
  observation::ServedBeacons served_;
  std::map<BeaconAddress, EffectiveSettings> effective_settings_;
  std::map<std::pair<std::string, std::uint64_t>, LineStatus> lines_;  ///< by name and bridge
  TimeNs began_ns_ = 0;
  TimeNs own_pause_ns_ = 0;  ///< the longest round of listening
};

SystemObserver::SystemObserver(const DoctorOptions& options)
    : options_(options),
      qos_(options.qos_file),
      participant_(options.domain),
      discovery_(participant_),
      admission_({}, options.max_beacons),
      fusion_limit_(&admission_),
      imu_(participant_, qos_, topics::imu, &admission_),
      fix_(participant_, qos_, topics::fix, &admission_),
      heading_(participant_, qos_, topics::heading, &admission_),
      pose_(participant_, qos_, topics::pose, &admission_),
      report_(participant_, qos_, topics::report, &admission_),
      beacon_status_(participant_, qos_, topics::beacon_status, &admission_),
      line_status_(participant_, qos_, topics::line_status, &line_limit_),
      fusion_status_(participant_, qos_, topics::fusion_status, &fusion_limit_),
      settings_(participant_, qos_, topics::settings) {
  for (const dds::ReadCondition* const condition :
       {&imu_.has_data, &fix_.has_data, &heading_.has_data, &pose_.has_data, &report_.has_data,
        &beacon_status_.has_data, &line_status_.has_data, &fusion_status_.has_data, &settings_.has_data}) {
    waitset_ += *condition;
  }
}

template <class T>
void SystemObserver::take(Subscription<T>& subscription) {
  const TimeNs received_ns = clocks::host_now();
  subscription.reader.take_each([&](const T& sample, const dds::SampleInfo& info) {
    auto value = dds::topics::from_idl(sample);
    if constexpr (std::is_same_v<T, sonopose_EffectiveSettings>) {
      effective_settings_[value.address] = std::move(value);
    } else if constexpr (std::is_same_v<T, sonopose_LineStatus>) {
      lines_[{value.name, value.bridge_id}] = std::move(value);
    } else {
      const auto [entry, is_new] = probes_.try_emplace(value.address);
      BeaconProbe& probe = entry->second;
      if (is_new && began_ns_ != 0) probe.begin(began_ns_);
      if constexpr (std::is_same_v<T, sonopose_FusedPose> || std::is_same_v<T, sonopose_FusionStatus>) {
        served_.on(value, info.publication_handle());
      }
      if constexpr (std::is_same_v<T, sonopose_ImuSample>) {
        probe.on(value, received_ns, info.publication_handle().value);
      } else if constexpr (std::is_same_v<T, sonopose_FixReport> ||
                           std::is_same_v<T, sonopose_BeaconStatus> ||
                           std::is_same_v<T, sonopose_FusionStatus>) {
        probe.on(value);
      } else {
        probe.on(value, received_ns);
      }
    }
  });
}

void SystemObserver::take_all() {
  take(imu_);
  take(fix_);
  take(heading_);
  take(pose_);
  take(report_);
  take(beacon_status_);
  take(line_status_);
  take(fusion_status_);
  take(settings_);
}

void SystemObserver::listen_until(SteadyTime end, const process::StopSignal& stop) {
  constexpr std::chrono::milliseconds poll_period(20);
  while (clocks::steady_now() < end && !stop.requested()) {
    const SteadyTime before = clocks::steady_now();
    waitset_.wait(std::min<dds::Duration>(poll_period, dds::Duration(end - before)));
    take_all();
    own_pause_ns_ = std::max<TimeNs>(own_pause_ns_, clocks::steady_now() - before);
  }
}

template <class T>
double SystemObserver::deadline_s(const dds::topics::Entry<T>& entry) const {
  const dds::Duration deadline = dds::deadline_of(qos_.datareader_qos(entry.profile));
  if (deadline == dds::infinite) return std::numeric_limits<double>::infinity();
  return std::chrono::duration<double>(deadline).count();
}

std::vector<rules::ProcessObservation> SystemObserver::processes_of(
    const std::set<std::uint64_t>& imu_writers, const Processes& processes) {
  std::vector<rules::ProcessObservation> found;
  const auto matched = imu_.reader.matched_publications();
  for (const std::uint64_t writer : imu_writers) {
    if (std::find(matched.begin(), matched.end(), dds::InstanceHandle{writer}) == matched.end()) continue;
    try {
      const auto key = dds::text_of(imu_.reader.matched_publication_data({writer}).participant_key);
      found.push_back(process_of(processes, key));
    } catch (const dds::Error&) {
      continue;  // it has just disappeared
    }
  }
  return found;
}

rules::BeaconObservation SystemObserver::observation_of(BeaconAddress address, const BeaconProbe& probe,
                                                        TimeNs now_ns, const process::StopSignal& stop) {
  auto settings = effective_settings_.find(address);
  if (settings == effective_settings_.end()) settings = effective_settings_.find(all_beacons);
  rules::BeaconObservation beacon = probe.observation(
      now_ns, settings == effective_settings_.end() ? settings::Settings{} : settings_from(settings->second),
      [&stop] { return stop.requested(); });
  beacon.address = address;
  beacon.imu.deadline_s = deadline_s(topics::imu);
  beacon.fix.deadline_s = deadline_s(topics::fix);
  beacon.heading.deadline_s = deadline_s(topics::heading);
  beacon.pose.deadline_s = deadline_s(topics::pose);
  return beacon;
}

/// Whether another process has an endpoint here.
bool SystemObserver::is_alone() {
  const std::string own_key = discovery_.own_key();
  const auto is_own = [&own_key](const dds::FoundEndpoint& each) { return each.participant_key == own_key; };
  const auto writers = discovery_.writers();
  const auto readers = discovery_.readers();
  return std::all_of(writers.begin(), writers.end(), is_own) &&
         std::all_of(readers.begin(), readers.end(), is_own);
}

/// An empty domain is left early: there is nothing to see, and the others are searched next.
void SystemObserver::listen_for_window(const process::StopSignal& stop) {
  constexpr double enough_of_nothing_s = 2.0;
  const SteadyTime began = clocks::steady_now();
  listen_until(began + to_ns(std::min(options_.duration_s, enough_of_nothing_s)), stop);
  if (!is_alone()) listen_until(began + to_ns(options_.duration_s), stop);
}

rules::Observations SystemObserver::run(const process::StopSignal& stop) {
  // Sufficient for discovery over a network.
  constexpr TimeNs discovery_ns = 500'000'000;
  listen_until(clocks::steady_now() + discovery_ns, stop);
  began_ns_ = clocks::host_now();
  own_pause_ns_ = 0;
  for (auto& entry : probes_) entry.second.begin(began_ns_);
  listen_for_window(stop);
  const TimeNs ended_ns = clocks::host_now();

  const Processes processes = processes_in(discovery_.participants());
  const std::string own_key = discovery_.own_key();
  rules::Observations observations;
  observations.window_s = seconds_between(began_ns_, ended_ns);
  observations.own_pause_s = seconds_between(0, own_pause_ns_);
  observations.bus = bus_of(options_.domain);
  observations.own_host = process_of(processes, own_key).host;
  observations.native_topics = native_topics();
  observations.writers = others_of(discovery_.writers(), processes, own_key);
  observations.readers = others_of(discovery_.readers(), processes, own_key);
  for (const auto& entry : lines_) observations.lines.push_back(entry.second);
  observations.pose_writers =
      observation::pose_writers_of(discovery_.writers(), discovery_.participants(), served_);
  // Before the fits, which take a while.
  std::map<BeaconAddress, std::vector<rules::ProcessObservation>> bridges;
  for (const auto& [address, probe] : probes_) bridges[address] = processes_of(probe.writers(), processes);
  for (const auto& [address, probe] : probes_) {
    observations.beacons.push_back(observation_of(address, probe, ended_ns, stop));
    observations.beacons.back().bridges = std::move(bridges.at(address));
  }
  observations.beacons_refused = admission_.warning();
  return observations;
}

}  // namespace

rules::Observations observe(const DoctorOptions& options, const process::StopSignal& stop) {
  rules::Observations observations = SystemObserver(options).run(stop);
  if (rules::on_topic(observations.writers, topics::imu.name).empty() ||
      rules::on_topic(observations.writers, topics::pose.name).empty()) {
    search_other_domains(options.domain, stop, observations.bus);
  }
  return observations;
}

}  // namespace sonopose::doctor::probe
