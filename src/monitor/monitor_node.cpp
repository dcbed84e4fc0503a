#include "monitor/monitor_node.hpp"

#include "monitor/monitor_report.hpp"
#include "observation/beacon_observers.hpp"
#include "process/clocks.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace sonopose::monitor {
namespace {

namespace topics = dds::topics;

/// One topic that is watched.
template <class T>
struct Watched {
  Watched(const dds::DomainParticipant& participant, const dds::QosProvider& qos,
          const dds::TopicEntry<T>& entry, observation::BeaconObservers& watches,
          process::EndpointCounters& ends)
      : listener(watches, ends), reader(dds::make_reader(participant, qos, entry, &listener)) {}

  observation::ObservingListener<T> listener;
  dds::DataReader<T> reader;
};

void print(const MonitorOptions& options, const std::vector<observation::BeaconView>& views) {
  if (options.json) {
    fmt::print("{}\n", json_of(views, process::host_now()));
  } else {
    // Home, then clear what is below: the table stays where it is.
    fmt::print("{}{}", options.redraw ? "\x1b[H\x1b[J" : "", table_of(views));
  }
  std::fflush(stdout);
}

/// Tells what the middleware said of this program's own readers, where it is more than it was.
class EndsTeller {
public:
  void operator()(const process::EndpointCounters& ends) {
    tell(ends.incompatible_qos, incompatible_reported_,
         "writers offer QoS that does not go with its own; sonopose-doctor tells which");
    tell(ends.samples_lost, lost_reported_, "samples were lost on the way here");
    tell(ends.samples_rejected, rejected_reported_, "samples were refused for want of room");
  }

private:
  static void tell(std::uint64_t count, std::uint64_t& told, const char* what) {
    if (count != told) fmt::print(stderr, "sonopose-monitor: {} {}\n", count - told, what);
    told = count;
  }

  std::uint64_t incompatible_reported_ = 0;
  std::uint64_t lost_reported_ = 0;
  std::uint64_t rejected_reported_ = 0;
};

/// At once, and beside the table: whoever controls something by these poses must know.
void log_silences(const std::vector<process::SilenceDetector::Change>& changes) {
  for (const auto& change : changes) {
    if (change.silent) {
      fmt::print(stderr, "sonopose-monitor: beacon {}: no pose for {:.3f} s\n", change.address,
                 change.lasted_s);
    } else {
      fmt::print(stderr, "sonopose-monitor: beacon {}: poses again, after {:.3f} s\n", change.address,
                 change.lasted_s);
    }
  }
}

}  // namespace

std::uint64_t monitor(const MonitorOptions& options, const process::StopSignal& stop) {
  const dds::QosProvider qos(options.qos_file);
  const dds::DomainParticipant participant(options.domain);
  observation::BeaconObservers watches(dds::deadline_of(qos.datareader_qos(topics::pose.profile)).count());
  process::EndpointCounters ends;
  EndsTeller log_ends;
  const Watched pose(participant, qos, topics::pose, watches, ends);
  const Watched truth(participant, qos, topics::truth, watches, ends);
  const Watched beacon_status(participant, qos, topics::beacon_status, watches, ends);
  const Watched fusion_status(participant, qos, topics::fusion_status, watches, ends);

  constexpr TimeNs period_ns = 1'000'000'000;
  SteadyTime next = process::steady_now() + period_ns;
  const SteadyTime end =
      options.duration_s > 0 ? process::steady_now() + to_ns(options.duration_s) : SteadyTime::max();
  if (options.redraw) fmt::print("\x1b[2J");
  constexpr TimeNs look_period_ns = 20'000'000;
  while (next <= end && !stop.wait_until(std::min(next, process::steady_now() + look_period_ns))) {
    log_silences(watches.silence_changes());
    log_ends(ends);
    if (process::steady_now() < next) continue;
    const TimeNs now = process::host_now();
    print(options, watches.views([now](observation::BeaconObserver& watch, BeaconAddress address) {
      return watch.look(address, now);
    }));
    next += period_ns;
  }
  stop.wait_until(std::min(end, next));

  const TimeNs now = process::host_now();
  const auto summaries = watches.views([now](const observation::BeaconObserver& watch,
                                             BeaconAddress address) { return watch.summary(address, now); });
  if (!options.json) fmt::print("\n{}", summary_of(summaries));
  std::uint64_t poses = 0;
  for (const observation::BeaconView& view : summaries) poses += view.poses;
  return poses;
}

}  // namespace sonopose::monitor
