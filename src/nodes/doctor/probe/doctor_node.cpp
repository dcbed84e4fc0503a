#include "doctor/probe/doctor_node.hpp"

#include "clocks/clocks.hpp"
#include "doctor/probe/beacon_probe.hpp"
#include "doctor/probe/survey.hpp"
#include "observation/bus/line_observer.hpp"
#include "observation/own_reports.hpp"
#include "presence/instance_limit.hpp"
#include <sonopose/dds/binding/refused_peer.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sonopose::doctor::probe {
namespace {

namespace topics = dds::topics;

constexpr double poll_period_s = 0.02;

/// A subscription to one topic. Keeps all samples until they are taken: losses during a pause of the doctor
/// would look like losses of the system.
template <class T>
struct Subscription {
  template <class Filter = dds::topics::AddressFilter>
  Subscription(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
               const dds::topics::Entry<T>& entry, Filter* filter = nullptr)
      : reader(dds::topics::make_reader(participant, qos, entry, nullptr, dds::topics::Delivery::lossless,
                                        filter)),
        has_data(reader, dds::sub::status::DataState::any()) {}

  dds::sub::DataReader<T> reader;
  dds::sub::cond::ReadCondition has_data;
};

/// Returns the processes without readers and writers. `early` were there when the observation began.
Processes without_topics(const dds::Discovery& discovery, const Processes& processes,
                         const Processes& early) {
  Processes found = processes;
  found.erase(discovery.own_key());
  for (const auto& endpoint : discovery.writers()) found.erase(endpoint.participant_key);
  for (const auto& endpoint : discovery.readers()) found.erase(endpoint.participant_key);
  std::erase_if(found, [&](const auto& each) { return !early.contains(each.first); });
  return found;
}

/// Names the processes that DDS Security refused: those that it reports, then those without visible topics.
std::vector<std::string> refused_of(Processes hidden) {
  std::vector<std::string> texts;
  bool is_any_unknown = false;
  for (const dds::RefusedPeer& peer : dds::refused_peers()) {
    const auto is_it = [&](const auto& each) {
      return !peer.key_prefix.empty() && each.first.starts_with(peer.key_prefix);
    };
    const auto found = std::ranges::find_if(hidden, is_it);
    const bool is_known = found != hidden.end();
    texts.push_back(is_known ? observation::text_of(found->second) + ": " + peer.reason : dds::text_of(peer));
    if (is_known) hidden.erase(found);
    is_any_unknown |= peer.key_prefix.empty();
  }
  for (const auto& [key, process] : hidden) {
    texts.push_back(observation::text_of(process) +
                    (is_any_unknown ? ": it has no certificate, or owns one that is named above"
                                    : ": it has no certificate of this key store"));
  }
  return texts;
}

class SystemObserver {
public:
  explicit SystemObserver(const DoctorOptions& options);

  /// Observes everything but the pieces of the beacons.
  rules::Observations run(const process::StopSignal& stop);

  /// Returns the samples of each beacon, for its pieces.
  [[nodiscard]] std::map<BeaconAddress, BeaconProbe> take_probes() { return std::move(probes_); }

private:
  void listen_until(SteadyTime end, const process::StopSignal& stop);
  void listen_for_window(const process::StopSignal& stop);
  [[nodiscard]] bool is_alone();
  void take_all();
  template <class T>
  void take(Subscription<T>& subscription, const Arrival& arrival);
  template <class T>
  [[nodiscard]] double deadline_s(const dds::topics::Entry<T>& entry) const;
  /// The processes of these IMU writers, as far as they still exist.
  [[nodiscard]] std::vector<rules::ProcessObservation> processes_of(
      const std::set<std::uint64_t>& imu_writers, const Processes& processes);
  [[nodiscard]] settings::Settings settings_of(BeaconAddress address) const;

  const DoctorOptions& options_;
  dds::qos::Provider qos_;
  dds::domain::DomainParticipant participant_;
  dds::Discovery discovery_;
  presence::BeaconAdmission admission_;
  presence::InstanceLimit<sonopose_FusionStatus> fusion_limit_;
  Subscription<sonopose_ImuSample> imu_;
  Subscription<sonopose_UltrasonicFix> fix_;
  Subscription<sonopose_PairHeading> heading_;
  Subscription<sonopose_TwistSample> twist_;
  Subscription<sonopose_FusedPose> pose_;
  Subscription<sonopose_FixReport> report_;
  Subscription<sonopose_BeaconStatus> beacon_status_;
  Subscription<sonopose_FusionStatus> fusion_status_;
  Subscription<sonopose_EffectiveSettings> settings_;
  observation::bus::LineObserver lines_;
  Deadlines deadlines_;
  dds::core::cond::WaitSet waitset_;
  std::map<BeaconAddress, BeaconProbe> probes_;
  observation::ServedBeacons served_;
  observation::OwnReports own_reports_;
  std::map<BeaconAddress, EffectiveSettings> effective_settings_;
  std::optional<SteadyTime> began_;
  SteadyTime taken_ = clocks::steady_now();  ///< time of the last take
};

SystemObserver::SystemObserver(const DoctorOptions& options)
    : options_(options),
      qos_(options.qos_file),
      participant_(dds::ext::participant(options.domain)),
      discovery_(participant_),
      admission_({}, options.max_beacons),
      fusion_limit_(&admission_),
      imu_(participant_, qos_, topics::imu, &admission_),
      fix_(participant_, qos_, topics::fix, &admission_),
      heading_(participant_, qos_, topics::heading, &admission_),
      twist_(participant_, qos_, topics::twist, &admission_),
      pose_(participant_, qos_, topics::pose, &admission_),
      report_(participant_, qos_, topics::report, &admission_),
      beacon_status_(participant_, qos_, topics::beacon_status, &admission_),
      fusion_status_(participant_, qos_, topics::fusion_status, &fusion_limit_),
      settings_(participant_, qos_, topics::settings),
      lines_(participant_, qos_),
      deadlines_{.imu_s = deadline_s(topics::imu),
                 .fix_s = deadline_s(topics::fix),
                 .heading_s = deadline_s(topics::heading),
                 .pose_s = deadline_s(topics::pose)} {
  for (const dds::sub::cond::ReadCondition* const condition :
       {&imu_.has_data, &fix_.has_data, &heading_.has_data, &twist_.has_data, &pose_.has_data,
        &report_.has_data, &beacon_status_.has_data, &fusion_status_.has_data, &settings_.has_data}) {
    waitset_ += *condition;
  }
}

template <class T>
void SystemObserver::take(Subscription<T>& subscription, const Arrival& arrival) {
  const auto on_state = [&](const T& key, const dds::sub::SampleInfo& info) {
    if constexpr (std::is_same_v<T, sonopose_FusionStatus>) {
      if (dds::ext::is_alive(info)) return;
      fusion_limit_.forget(key);
      const auto probe = probes_.find(key.address);
      if (probe != probes_.end()) probe->second.end_fusion(key.fusion_id);
    }
  };
  const auto on_data = [&](const T& sample, const dds::sub::SampleInfo& info) {
    on_state(sample, info);
    if (std::is_same_v<T, sonopose_FusionStatus> && !dds::ext::is_alive(info)) return;
    auto value = dds::topics::from_idl(sample);
    if constexpr (std::is_same_v<T, sonopose_EffectiveSettings>) {
      effective_settings_[value.address] = std::move(value);
    } else {
      if constexpr (std::is_same_v<T, sonopose_FixReport>) {
        if (!own_reports_.accepts(value.address, report_.reader, info.publication_handle(), pose_.reader,
                                  served_.pose_writer_of(value.address))) {
          return;
        }
      }
      const auto [entry, is_new] = probes_.try_emplace(value.address);
      BeaconProbe& probe = entry->second;
      if (is_new && began_) probe.begin(began_->ns, deadlines_);
      if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
        served_.on_pose(value.address, info.publication_handle(), clocks::steady_now());
      } else if constexpr (std::is_same_v<T, sonopose_FusionStatus>) {
        served_.on(value, info.publication_handle(), clocks::steady_now());
      }
      if constexpr (std::is_same_v<T, sonopose_ImuSample>) {
        probe.on(value, arrival, info.publication_handle().c_value());
      } else if constexpr (std::is_same_v<T, sonopose_BeaconStatus> ||
                           std::is_same_v<T, sonopose_FusionStatus>) {
        probe.on(value);
      } else {
        probe.on(value, arrival);
      }
    }
  };
  dds::ext::take_each(subscription.reader, on_data, on_state);
}

/// Takes all samples. Those that waited while this process was paused may have arrived at any time since the
/// previous call.
void SystemObserver::take_all() {
  const SteadyTime now = clocks::steady_now();
  const TimeNs unwatched_ns = std::max<TimeNs>(0, now - taken_ - to_ns(poll_period_s));
  const Arrival arrival(now.ns, clocks::host_now(), unwatched_ns);
  taken_ = now;
  take(imu_, arrival);
  take(fix_, arrival);
  take(heading_, arrival);
  take(twist_, arrival);
  take(pose_, arrival);
  take(report_, arrival);
  take(beacon_status_, arrival);
  take(fusion_status_, arrival);
  take(settings_, arrival);
  lines_.take();
}

void SystemObserver::listen_until(SteadyTime end, const process::StopSignal& stop) {
  while (!stop.requested()) {
    const TimeNs left_ns = end - clocks::steady_now();
    if (left_ns <= 0) return;
    dds::ext::wait(waitset_, std::chrono::nanoseconds(std::min(left_ns, to_ns(poll_period_s))));
    take_all();
  }
}

template <class T>
double SystemObserver::deadline_s(const dds::topics::Entry<T>& entry) const {
  const std::chrono::nanoseconds deadline = dds::deadline_of(qos_.datareader_qos(entry.profile));
  if (deadline == dds::ext::infinite) return std::numeric_limits<double>::infinity();
  return std::chrono::duration<double>(deadline).count();
}

std::vector<rules::ProcessObservation> SystemObserver::processes_of(
    const std::set<std::uint64_t>& imu_writers, const Processes& processes) {
  std::vector<rules::ProcessObservation> found;
  const auto matched = dds::ext::matched_publications(imu_.reader);
  for (const std::uint64_t writer : imu_writers) {
    const dds::core::InstanceHandle handle(writer);
    if (std::find(matched.begin(), matched.end(), handle) == matched.end()) continue;
    if (const auto data = dds::ext::matched_publication_data(imu_.reader, handle)) {
      found.push_back(process_of(processes, dds::ext::text_of(data->participant_key)));
    }
  }
  return found;
}

settings::Settings SystemObserver::settings_of(BeaconAddress address) const {
  auto settings = effective_settings_.find(address);
  if (settings == effective_settings_.end()) settings = effective_settings_.find(all_beacons);
  return settings == effective_settings_.end() ? settings::Settings{} : settings_from(settings->second);
}

/// True if no other process has an endpoint here.
bool SystemObserver::is_alone() {
  const std::string own_key = discovery_.own_key();
  const auto is_own = [&own_key](const dds::FoundEndpoint& each) { return each.participant_key == own_key; };
  const auto writers = discovery_.writers();
  const auto readers = discovery_.readers();
  return std::all_of(writers.begin(), writers.end(), is_own) &&
         std::all_of(readers.begin(), readers.end(), is_own);
}

/// Listens for the window. Leaves an empty domain early, to search the others.
void SystemObserver::listen_for_window(const process::StopSignal& stop) {
  constexpr double empty_domain_timeout_s = 2.0;
  const SteadyTime began = clocks::steady_now();
  listen_until(began + to_ns(std::min(options_.duration_s, empty_domain_timeout_s)), stop);
  if (!is_alone()) listen_until(began + to_ns(options_.duration_s), stop);
}

rules::Observations SystemObserver::run(const process::StopSignal& stop) {
  // Enough for discovery over a network.
  constexpr TimeNs discovery_ns = 500'000'000;
  listen_until(clocks::steady_now() + discovery_ns, stop);
  began_ = clocks::steady_now();
  for (auto& entry : probes_) entry.second.begin(began_->ns, deadlines_);
  const Processes early = processes_in(discovery_.participants());
  listen_for_window(stop);
  const SteadyTime ended = clocks::steady_now();

  const Processes processes = processes_in(discovery_.participants());
  const std::string own_key = discovery_.own_key();
  rules::Observations observations;
  observations.window_s = seconds_between(*began_, ended);
  if (stop.requested() && observations.window_s < options_.duration_s) {
    observations.cut_from_s = options_.duration_s;
  }
  observations.bus = bus_of(options_.domain);
  const Processes hidden = without_topics(discovery_, processes, early);
  observations.bus.without_topics = hidden.size();
  if (observations.bus.is_secured) observations.bus.refused = refused_of(hidden);
  observations.own_host = process_of(processes, own_key).host;
  observations.native_topics = native_topics();
  observations.writers = others_of(discovery_.writers(), processes, own_key);
  observations.readers = others_of(discovery_.readers(), processes, own_key);
  for (const auto& entry : lines_.lines()) observations.lines.push_back(entry.second);
  observations.pose_writers =
      observation::pose_writers_of(discovery_.writers(), discovery_.participants(), served_, ended);
  for (const auto& [address, probe] : probes_) {
    rules::BeaconObservation& beacon =
        observations.beacons.emplace_back(probe.observation(ended.ns, settings_of(address)));
    beacon.address = address;
    beacon.bridges = processes_of(probe.writers(), processes);
  }
  observations.beacons_refused = admission_.warning();
  for (auto& text : {fusion_limit_.warning(), lines_.warning()}) {
    if (text) observations.not_observed.push_back(*text);
  }
  return observations;
}

/// Fits the motion of each beacon, as far as the processor time suffices: a busy machine takes longer and
/// finds the same.
void fit(const std::map<BeaconAddress, BeaconProbe>& probes, const DoctorOptions& options,
         const process::StopSignal& stop, rules::Observations& observations) {
  const TimeNs end_ns = clocks::thread_time_ns() + to_ns(options.fits_s);
  const auto is_over = [&] { return stop.requested() || clocks::thread_time_ns() >= end_ns; };
  std::size_t done = 0;
  for (rules::BeaconObservation& beacon : observations.beacons) {
    if (options.on_fit) options.on_fit(static_cast<double>(done++) / static_cast<double>(probes.size()));
    bool was_cut = is_over();
    beacon.pieces = probes.at(beacon.address).pieces(beacon.fusion_settings, [&] {
      was_cut = was_cut || is_over();
      return was_cut;
    });
    if (was_cut) ++observations.beacons_not_fitted;
  }
}

}  // namespace

rules::Observations observe(const DoctorOptions& options, const process::StopSignal& stop) {
  // The observer ends before the fits: its readers would keep receiving during them.
  auto observer = std::make_unique<SystemObserver>(options);
  rules::Observations observations = observer->run(stop);
  const auto probes = observer->take_probes();
  observer.reset();
  fit(probes, options, stop, observations);
  if (rules::on_topic(observations.writers, topics::imu.name).empty() ||
      rules::on_topic(observations.writers, topics::pose.name).empty()) {
    search_other_domains(options.domain, stop, observations.bus);
  }
  return observations;
}

}  // namespace sonopose::doctor::probe
