#include <sonopose/dds/conversions.hpp>
#include <sonopose/dds/participant.hpp>
#include <sonopose/dds/topics.hpp>
#include <sonopose/nodes/beacon_view.hpp>
#include <sonopose/nodes/end_counters.hpp>
#include <sonopose/nodes/host_clock.hpp>
#include <sonopose/nodes/monitor_node.hpp>
#include <sonopose/nodes/monitor_report.hpp>
#include <sonopose/nodes/silence_watch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <mutex>

namespace sonopose::nodes {
namespace {

namespace topics = dds::topics;

/// All beacons; filled by Cyclone's threads, looked at by the main one.
class Watches {
public:
  explicit Watches(TimeNs pose_deadline_ns) : silences_(pose_deadline_ns) {}

  template <class Sample>
  void on(const Sample& sample) {
    const std::lock_guard lock(mutex_);
    watches_[sample.address].on(sample);
  }

  void on(const FusedPose& pose, TimeNs received_ns, dds::InstanceHandle writer) {
    const std::lock_guard lock(mutex_);
    pose_writers_[pose.address] = writer;
    watches_[pose.address].on(pose, received_ns);
    silences_.on_sample(pose.address, steady_now_ns());
  }

  void on_deadline_missed(BeaconAddress address, std::uint64_t count) {
    const std::lock_guard lock(mutex_);
    watches_[address].on_deadline_missed(count);
  }

  /// A writer of poses lives no more: so do the beacons that it wrote last, until another one takes over.
  void on_pose_writer_lost(dds::InstanceHandle lost) {
    const std::lock_guard lock(mutex_);
    for (const auto& [address, writer] : pose_writers_) {
      if (writer == lost) watches_[address].on_pose_lost();
    }
  }

  /// An instance lost its last writer.
  void on_gone(const sonopose_FusedPose& key) {
    const std::lock_guard lock(mutex_);
    watches_[key.address].on_pose_lost();
  }
  void on_gone(const sonopose_FusionStatus& key) {
    const std::lock_guard lock(mutex_);
    watches_[key.address].on_fusion_gone(key.fusion_id);
  }
  template <class Other>
  void on_gone(const Other& /*key*/) {}

  /// What fell silent or was heard again since the last call.
  std::vector<SilenceWatch::Change> silence_changes() {
    std::vector<SilenceWatch::Change> changes;
    const std::lock_guard lock(mutex_);
    silences_.find_changes(steady_now_ns(), changes);
    return changes;
  }

  /// `look(watch, address)` for each beacon, in the order of addresses.
  template <class Look>
  std::vector<BeaconView> views(const Look& look) {
    const std::lock_guard lock(mutex_);
    std::vector<BeaconView> views;
    for (auto& [address, watch] : watches_) views.push_back(look(watch, address));
    return views;
  }

private:
  std::mutex mutex_;
  std::map<BeaconAddress, BeaconWatch> watches_;
  std::map<BeaconAddress, dds::InstanceHandle> pose_writers_;
  SilenceWatch silences_;
};

template <class T>
class WatchListener : public CountingReaderListener<T> {
public:
  WatchListener(Watches& watches, EndCounters& ends) : CountingReaderListener<T>(ends), watches_(watches) {}

  void on_data_available(dds::DataReader<T>& reader) noexcept override {
    const TimeNs received_ns = now_ns();
    const auto on_data = [&](const T& sample, const dds::SampleInfo& info) {
      if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
        watches_.on(dds::from_idl(sample), received_ns, info.publication_handle());
      } else {
        watches_.on(dds::from_idl(sample));
      }
    };
    reader.try_take_each(on_data, [&](const T& key, const dds::SampleInfo& info) {
      if (!info.alive()) watches_.on_gone(key);
    });
  }

  void on_liveliness_changed(dds::DataReader<T>& /*reader*/,
                             const dds::LivelinessChangedStatus& status) noexcept override {
    if (std::is_same_v<T, sonopose_FusedPose> && status.not_alive_count_change > 0) {
      watches_.on_pose_writer_lost({status.last_publication_handle});
    }
  }

  void on_requested_deadline_missed(dds::DataReader<T>& reader,
                                    const dds::RequestedDeadlineMissedStatus& status) noexcept override {
    if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
      T key{};
      if (reader.try_key_value(key, {status.last_instance_handle}) < 0) return;
      watches_.on_deadline_missed(key.address, static_cast<std::uint64_t>(status.total_count_change));
    }
  }

private:
  Watches& watches_;
};

/// One topic that is watched.
template <class T>
struct Watched {
  Watched(const dds::DomainParticipant& participant, const dds::QosProvider& qos,
          const dds::TopicEntry<T>& entry, Watches& watches, EndCounters& ends)
      : listener(watches, ends), reader(dds::make_reader(participant, qos, entry, &listener)) {}

  WatchListener<T> listener;
  dds::DataReader<T> reader;
};

void print(const MonitorOptions& options, const std::vector<BeaconView>& views) {
  if (options.json) {
    fmt::print("{}\n", json_of(views, now_ns()));
  } else {
    // Home, then clear what is below: the table stays where it is.
    fmt::print("{}{}", options.redraw ? "\x1b[H\x1b[J" : "", table_of(views));
  }
  std::fflush(stdout);
}

/// Tells what the middleware said of this program's own readers, where it is more than it was.
class EndsTeller {
public:
  void operator()(const EndCounters& ends) {
    tell(ends.incompatible_qos, incompatible_told_,
         "writers offer QoS that does not go with its own; sonopose-doctor tells which");
    tell(ends.samples_lost, lost_told_, "samples were lost on the way here");
    tell(ends.samples_rejected, rejected_told_, "samples were refused for want of room");
  }

private:
  static void tell(std::uint64_t count, std::uint64_t& told, const char* what) {
    if (count != told) fmt::print(stderr, "sonopose-monitor: {} {}\n", count - told, what);
    told = count;
  }

  std::uint64_t incompatible_told_ = 0;
  std::uint64_t lost_told_ = 0;
  std::uint64_t rejected_told_ = 0;
};

/// At once, and beside the table: whoever controls something by these poses must know.
void tell_silences(const std::vector<SilenceWatch::Change>& changes) {
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

std::uint64_t monitor(const MonitorOptions& options, const StopSignal& stop) {
  const dds::QosProvider qos(options.qos_file);
  const dds::DomainParticipant participant(options.domain);
  Watches watches(dds::deadline_of(qos.datareader_qos(topics::pose.profile)).count());
  EndCounters ends;
  EndsTeller tell_ends;
  const Watched pose(participant, qos, topics::pose, watches, ends);
  const Watched truth(participant, qos, topics::truth, watches, ends);
  const Watched beacon_status(participant, qos, topics::beacon_status, watches, ends);
  const Watched fusion_status(participant, qos, topics::fusion_status, watches, ends);

  constexpr TimeNs period_ns = 1'000'000'000;
  TimeNs next_ns = steady_now_ns() + period_ns;
  const TimeNs end_ns = options.duration_s > 0 ? steady_now_ns() + to_ns(options.duration_s)
                                               : std::numeric_limits<TimeNs>::max();
  if (options.redraw) fmt::print("\x1b[2J");
  constexpr TimeNs look_period_ns = 20'000'000;
  while (next_ns <= end_ns && !stop.wait_until(std::min(next_ns, steady_now_ns() + look_period_ns))) {
    tell_silences(watches.silence_changes());
    tell_ends(ends);
    if (steady_now_ns() < next_ns) continue;
    const TimeNs now = now_ns();
    print(options, watches.views([now](BeaconWatch& watch, BeaconAddress address) {
      return watch.look(address, now);
    }));
    next_ns += period_ns;
  }
  stop.wait_until(std::min(end_ns, next_ns));

  const TimeNs now = now_ns();
  const auto summaries = watches.views(
      [now](const BeaconWatch& watch, BeaconAddress address) { return watch.summary(address, now); });
  if (!options.json) fmt::print("\n{}", summary_of(summaries));
  std::uint64_t poses = 0;
  for (const BeaconView& view : summaries) poses += view.poses;
  return poses;
}

}  // namespace sonopose::nodes
