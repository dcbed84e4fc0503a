#include "monitor/monitor_node.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "monitor/display.hpp"
#include "monitor/monitor_report.hpp"
#include "observation/beacon_observers.hpp"
#include "process/free_memory.hpp"
#include "terminal/crash_restore.hpp"
#include <sonopose/dds/binding/discovery.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::monitor {
namespace {

namespace topics = dds::topics;

/// Runs in the receive threads.
template <class T>
class Listener final : public observation::ObservingListener<T> {
public:
  using observation::ObservingListener<T>::ObservingListener;

private:
  void on_sample(const typename observation::ObservingListener<T>::Native& /*sample*/) noexcept override {
    terminal::unblock_crash_signals();
  }
};

/// When samples are taken.
enum class Taking : std::uint8_t {
  on_arrival,  ///< one by one in the receive threads: the time of arrival counts
  in_batches   ///< by `take`: costs less
};

/// A subscription to one topic.
template <class T>
struct Subscription {
  Subscription(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
               const dds::topics::Entry<T>& entry, observation::BeaconObservers& observers,
               process::BeaconAdmission& admission, process::EndpointCounters& endpoints, Taking taking)
      : listener(observers, endpoints),
        reader(dds::topics::make_reader(participant, qos, entry, &listener, dds::topics::Delivery::live,
                                        &admission, mask_of(taking))) {}

  /// Takes what has arrived.
  void take() { listener.on_data_available(reader); }

  Listener<T> listener;
  dds::DataReader<T> reader;

private:
  static dds::StatusMask mask_of(Taking taking) {
    const auto all = dds::StatusMask::all();
    return taking == Taking::on_arrival ? all : all.without(dds::StatusMask::data_available());
  }
};

/// What the monitor reads. The latency is that of the poses, so they are taken on arrival.
struct Subscriptions {
  Subscriptions(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                observation::BeaconObservers& observers, process::BeaconAdmission& admission,
                process::EndpointCounters& endpoints, bool has_reports)
      : pose(participant, qos, topics::pose, observers, admission, endpoints, Taking::on_arrival),
        truth(participant, qos, topics::truth, observers, admission, endpoints, Taking::in_batches),
        beacon_status(participant, qos, topics::beacon_status, observers, admission, endpoints,
                      Taking::in_batches),
        estimate(participant, qos, topics::estimate, observers, admission, endpoints, Taking::in_batches),
        fusion_status(participant, qos, topics::fusion_status, observers, admission, endpoints,
                      Taking::in_batches) {
    if (has_reports) {
      report.emplace(participant, qos, topics::report, observers, admission, endpoints, Taking::in_batches);
    }
  }

  void take() {
    truth.take();
    beacon_status.take();
    estimate.take();
    fusion_status.take();
    if (report) report->take();
  }

  Subscription<sonopose_FusedPose> pose;
  Subscription<sonopose_TruthSample> truth;
  Subscription<sonopose_BeaconStatus> beacon_status;
  Subscription<sonopose_Estimate> estimate;
  Subscription<sonopose_FusionStatus> fusion_status;
  std::optional<Subscription<sonopose_FixReport>> report;
};

/// Logs increases of the counters of this program's own readers.
class EndpointLogger {
public:
  void log(const process::EndpointCounters& endpoints) {
    log_increase(endpoints.incompatible_qos, incompatible_reported_,
                 "writers offer incompatible QoS; run sonopose-doctor for details");
    log_increase(endpoints.samples_lost, lost_reported_, "samples were lost on the way to this program");
    log_increase(endpoints.samples_rejected, rejected_reported_,
                 "samples were rejected because a queue was full");
  }

private:
  static void log_increase(std::uint64_t count, std::uint64_t& reported, const char* what) {
    if (count != reported) logging::warning(fmt::format("{} {}", count - reported, what));
    reported = count;
  }

  std::uint64_t incompatible_reported_ = 0;
  std::uint64_t lost_reported_ = 0;
  std::uint64_t rejected_reported_ = 0;
};

/// Checks which processes write poses, and logs new problems. A problem counts when two checks in a row find
/// it, because a process that starts or ends appears in parts.
class PoseWriterLogger {
public:
  explicit PoseWriterLogger(const dds::DomainParticipant& participant) : discovery_(participant) {}

  void log(const observation::ServedBeacons& served) {
    std::vector<std::string> seen;
    std::vector<std::string> confirmed;
    for (const auto& problem : observation::problems_of(
             observation::pose_writers_of(discovery_.writers(), discovery_.participants(), served))) {
      seen.push_back(problem.what);
      if (contains(seen_, problem.what)) confirmed.push_back(problem.what);
    }
    for (const std::string& text : confirmed) {
      if (!contains(warnings_, text)) logging::warning(text);
    }
    seen_ = std::move(seen);
    warnings_ = std::move(confirmed);
  }

  /// The problems at the last check.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

private:
  static bool contains(const std::vector<std::string>& list, const std::string& text) {
    return std::find(list.begin(), list.end(), text) != list.end();
  }

  dds::Discovery discovery_;
  std::vector<std::string> seen_;
  std::vector<std::string> warnings_;
};

/// The lines of the bridges.
class LineObserver {
public:
  LineObserver(const dds::DomainParticipant& participant, const dds::qos::Provider& qos)
      : reader_(dds::topics::make_reader(participant, qos, topics::line_status)) {}

  /// One of each line that delivers no frames.
  std::vector<std::string> warnings() {
    reader_.try_take_each(
        [this](const sonopose_LineStatus& sample, const dds::SampleInfo& info) {
          if (!info.alive()) {
            lines_.erase({sample.name, sample.bridge_id});
            return;
          }
          LineStatus line = dds::topics::from_idl(sample);
          const std::pair key{line.name, line.bridge_id};
          if (lines_.size() < most_lines || lines_.contains(key)) lines_[key] = std::move(line);
        },
        [this](const sonopose_LineStatus& key, const dds::SampleInfo& info) {
          if (!info.alive()) lines_.erase({key.name, key.bridge_id});
        });
    std::vector<std::string> texts;
    for (const auto& [key, line] : lines_) {
      if (!line.text.empty()) texts.push_back(fmt::format("line {}: {}", line.name, line.text));
    }
    return texts;
  }

private:
  static constexpr std::size_t most_lines = 256;

  dds::DataReader<sonopose_LineStatus> reader_;
  std::map<std::pair<std::string, std::uint64_t>, LineStatus> lines_;  ///< by name and bridge
};

/// Immediately and to the log: a consumer that controls a vehicle with these poses is affected too.
void log_silences(const std::vector<observation::PoseSilence>& changes) {
  for (const auto& change : changes) {
    if (change.silent) {
      logging::warning(fmt::format("beacon {}: no pose for {:.3f} s", change.address, change.lasted_s));
    } else {
      logging::info(fmt::format("beacon {}: poses again, after {:.3f} s", change.address, change.lasted_s));
    }
  }
}

/// The beacons that are gone: the summary of the last visit of each.
class GoneBeacons {
public:
  /// Frees them, so that others may take their places.
  void remove(observation::BeaconObservers& observers, process::BeaconAdmission& admission) {
    const SteadyTime now = clocks::steady_now();
    for (observation::BeaconView& view : observers.remove_gone(now, clocks::host_now())) {
      admission.forget(view.address);
      logging::info(fmt::format("beacon {}: gone", view.address));
      poses_ += view.poses;
      summaries_.insert_or_assign(view.address, std::move(view));
      free_memory_.on_freed();
    }
    free_memory_.give_back(now);
  }

  /// Of all visits.
  [[nodiscard]] std::uint64_t poses() const { return poses_; }
  [[nodiscard]] const std::map<BeaconAddress, observation::BeaconView>& summaries() const {
    return summaries_;
  }

private:
  std::uint64_t poses_ = 0;
  std::map<BeaconAddress, observation::BeaconView> summaries_;
  process::FreeMemory free_memory_;
};

/// The next time of a period. What was missed while the process was stopped is left out.
SteadyTime after(SteadyTime due, TimeNs period_ns) {
  const SteadyTime now = clocks::steady_now();
  return due + period_ns > now ? due + period_ns : now + period_ns;
}

}  // namespace

std::uint64_t monitor(const MonitorOptions& options, process::StopSignal& stop) {
  const dds::qos::Provider qos(options.qos_file);
  std::unique_ptr<Display> display =
      make_display(options.output);  // sets the locale: before other threads run
  const dds::DomainParticipant participant(options.domain);
  observation::BeaconObservers observers(dds::deadline_of(qos.datareader_qos(topics::pose.profile)).count());
  process::BeaconAdmission admission({}, options.max_beacons);
  process::EndpointCounters endpoints;
  EndpointLogger endpoint_logger;
  // Only a screen shows what became of a fix.
  Subscriptions subscriptions(participant, qos, observers, admission, endpoints,
                              options.output == Output::screen);
  LineObserver lines(participant, qos);
  PoseWriterLogger pose_writers(participant);
  GoneBeacons gone;

  constexpr TimeNs period_ns = 1'000'000'000;
  constexpr TimeNs pose_writers_period_ns = 500'000'000;
  SteadyTime next = clocks::steady_now() + period_ns;
  SteadyTime next_pose_writers = clocks::steady_now() + pose_writers_period_ns;
  const SteadyTime end =
      options.duration_s > 0 ? clocks::steady_now() + to_ns(options.duration_s) : SteadyTime::max();
  // Reading keys 20 times a second is enough. Without a screen, a log line should come sooner.
  const TimeNs poll_period_ns = options.output == Output::screen ? 50'000'000 : 20'000'000;
  while (next <= end && !stop.wait_until(std::min(next, clocks::steady_now() + poll_period_ns))) {
    if (display->poll()) {
      stop.request();
      break;
    }
    subscriptions.take();
    log_silences(observers.silence_changes());
    endpoint_logger.log(endpoints);
    if (clocks::steady_now() >= next_pose_writers) {
      pose_writers.log(observers.served());
      next_pose_writers = after(next_pose_writers, pose_writers_period_ns);
    }
    if (clocks::steady_now() < next) continue;
    gone.remove(observers, admission);
    if (const auto text = admission.refusals()) logging::warning(*text);
    std::vector<std::string> warnings = lines.warnings();
    warnings.insert(warnings.end(), pose_writers.warnings().begin(), pose_writers.warnings().end());
    if (auto text = admission.warning()) warnings.push_back(*std::move(text));
    display->show(observers.take_windows(clocks::host_now()), std::move(warnings));
    next = after(next, period_ns);
  }
  stop.wait_until(std::min(end, next));
  subscriptions.take();
  display.reset();  // a screen ends before the summary

  std::vector<observation::BeaconView> summaries;
  for (const auto& entry : gone.summaries()) summaries.push_back(entry.second);
  const auto present = observers.summaries(clocks::host_now());
  summaries.insert(summaries.end(), present.begin(), present.end());
  if (options.output != Output::json) fmt::print("\n{}", summary_of(summaries));
  std::uint64_t poses = gone.poses();
  for (const observation::BeaconView& view : present) poses += view.poses;
  return poses;
}

}  // namespace sonopose::monitor
