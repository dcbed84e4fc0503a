#pragma once
/// \file
/// Observations of all beacons, for the monitor's table and the relay's diagnostics.

#include "clocks/clocks.hpp"
#include "observation/beacon_observer.hpp"
#include "observation/pose_writers.hpp"
#include "presence/beacon_presence.hpp"
#include "presence/silence.hpp"
#include "process/endpoint_counters.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace sonopose::observation {

/// A pose stream that fell silent or resumed.
struct PoseSilence : presence::Silence::Change {
  BeaconAddress address = 0;
};

/// Observers of all beacons. Thread-safe: Cyclone's receive threads write, another thread reads.
class BeaconObservers {
public:
  explicit BeaconObservers(TimeNs pose_deadline_ns) : pose_deadline_ns_(pose_deadline_ns) {}

  template <class Sample>
  void on(const Sample& sample) {
    const threads::Lock lock(mutex_);
    mark_heard(sample.address).observer.on(sample);
  }

  void on(const FusedPose& pose, TimeNs received_ns, dds::core::InstanceHandle writer) {
    const threads::Lock lock(mutex_);
    Beacon& beacon = mark_heard(pose.address);
    beacon.observer.on(pose, received_ns);
    beacon.pose_writer = writer;
    beacon.pose_silence.on_sample(beacon.presence.latest);
  }

  void on(const FusionStatus& status, dds::core::InstanceHandle writer) {
    const threads::Lock lock(mutex_);
    served_.on(status, writer, clocks::steady_now());
    mark_heard(status.address).observer.on(status);
  }

  void on_deadline_missed(BeaconAddress address, std::uint64_t count) {
    visit(address, [count](BeaconObserver& observer) { observer.on_deadline_missed(count); });
  }

  /// Reports that a pose writer lost its liveliness. The beacons that it wrote last are lost until another
  /// writer takes over.
  void on_pose_writer_lost(dds::core::InstanceHandle lost) {
    const threads::Lock lock(mutex_);
    for (auto& [address, beacon] : beacons_) {
      if (beacon.pose_writer == lost) beacon.observer.on_pose_lost();
    }
  }

  /// Reports that an instance lost its last writer.
  void on_gone(const sonopose_FusedPose& key) {
    visit(key.address, [](BeaconObserver& observer) { observer.on_pose_lost(); });
  }
  void on_gone(const sonopose_FusionStatus& key) {
    visit(key.address, [&key](BeaconObserver& observer) { observer.on_fusion_gone(key.fusion_id); });
  }
  void on_gone(const sonopose_Estimate& key) {
    visit(key.address, [&key](BeaconObserver& observer) { observer.on_estimate_gone(key.fusion_id); });
  }
  template <class Other>
  void on_gone(const Other& /*key*/) {}

  /// Returns the pose streams that fell silent or resumed since the last call.
  std::vector<PoseSilence> silence_changes() {
    std::vector<PoseSilence> changes;
    const SteadyTime now = clocks::steady_now();
    const threads::Lock lock(mutex_);
    for (auto& [address, beacon] : beacons_) {
      if (const auto change = beacon.pose_silence.find_change(now, pose_deadline_ns_)) {
        changes.push_back({*change, address});
      }
    }
    return changes;
  }

  /// Forgets the beacons that are gone (presence::BeaconPresence) and returns their summaries, ordered by
  /// address.
  std::vector<BeaconView> remove_gone(SteadyTime now, TimeNs now_ns) {
    std::vector<BeaconView> gone;
    const threads::Lock lock(mutex_);
    std::erase_if(beacons_, [&](const auto& entry) {
      mutex_.assert_held();
      const auto& [address, beacon] = entry;
      if (!beacon.presence.is_gone(now)) return false;
      gone.push_back(beacon.observer.summary(address, now_ns));
      served_.forget(address);
      return true;
    });
    std::sort(gone.begin(), gone.end(),
              [](const BeaconView& a, const BeaconView& b) { return a.address < b.address; });
    return gone;
  }

  ServedBeacons served() {
    const SteadyTime now = clocks::steady_now();
    const threads::Lock lock(mutex_);
    for (const auto& [address, beacon] : beacons_) {
      if (beacon.pose_writer) served_.on_pose(address, *beacon.pose_writer, now);
    }
    return served_;
  }

  /// Writer of the beacon's latest pose; empty without one.
  std::optional<dds::core::InstanceHandle> pose_writer_of(BeaconAddress address) {
    const threads::Lock lock(mutex_);
    const auto found = beacons_.find(address);
    return found == beacons_.end() ? std::nullopt : found->second.pose_writer;
  }

  /// Returns BeaconObserver::take_window of each beacon, ordered by address.
  std::vector<BeaconView> take_windows(TimeNs now_ns) {
    return views_of([now_ns](BeaconAddress address, BeaconObserver& observer) {
      return observer.take_window(address, now_ns);
    });
  }

  /// Returns BeaconObserver::summary of each beacon, ordered by address.
  std::vector<BeaconView> summaries(TimeNs now_ns) {
    return views_of([now_ns](BeaconAddress address, const BeaconObserver& observer) {
      return observer.summary(address, now_ns);
    });
  }

private:
  struct Beacon {
    BeaconObserver observer;
    std::optional<dds::core::InstanceHandle> pose_writer;  ///< writer of the latest pose
    presence::Silence pose_silence;
    presence::BeaconPresence presence;
  };

  /// Marks a beacon as heard, and returns it.
  Beacon& mark_heard(BeaconAddress address) SONOPOSE_REQUIRES(mutex_) {
    Beacon& beacon = beacons_[address];
    beacon.presence.on_sample(clocks::steady_now());
    return beacon;
  }

  /// Returns `view(address, observer)` of each beacon, ordered by address.
  std::vector<BeaconView> views_of(const auto& view) {
    const threads::Lock lock(mutex_);
    std::vector<std::pair<BeaconAddress, BeaconObserver*>> observers;
    observers.reserve(beacons_.size());
    for (auto& [address, beacon] : beacons_) observers.emplace_back(address, &beacon.observer);
    std::sort(observers.begin(), observers.end());
    std::vector<BeaconView> views;
    views.reserve(observers.size());
    for (const auto& [address, observer] : observers) views.push_back(view(address, *observer));
    return views;
  }

  void visit(BeaconAddress address, const auto& change) {
    const threads::Lock lock(mutex_);
    if (const auto found = beacons_.find(address); found != beacons_.end()) change(found->second.observer);
  }

  TimeNs pose_deadline_ns_;
  threads::Mutex mutex_;
  std::unordered_map<BeaconAddress, Beacon> beacons_ SONOPOSE_GUARDED_BY(mutex_);
  ServedBeacons served_ SONOPOSE_GUARDED_BY(mutex_);
};

/// Passes samples and statuses of one topic to the observers. A derived class may override `on_gone`, and
/// `on_sample`, which is called for each sample first, and `accepts`, which leaves samples out.
template <class T>
class ObservingListener : public process::CountingReaderListener<T> {
public:
  using Native = decltype(dds::topics::from_idl(std::declval<const T&>()));

  ObservingListener(BeaconObservers& observers, process::EndpointCounters& endpoints)
      : process::CountingReaderListener<T>(endpoints), observers_(observers) {}

  void on_data_available(dds::sub::DataReader<T>& reader) noexcept override {
    const TimeNs received_ns = clocks::host_now();
    const auto on_data = [&](const T& sample, const dds::sub::SampleInfo& info) {
      const Native native = dds::topics::from_idl(sample);
      if (!accepts(reader, native, info)) return;
      on_sample(native);
      if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
        observers_.on(native, received_ns, info.publication_handle());
      } else if constexpr (std::is_same_v<T, sonopose_FusionStatus>) {
        observers_.on(native, info.publication_handle());
      } else {
        observers_.on(native);
      }
      // A fusion that gives up a beacon ends its instance of the pose, which another fusion may write.
      if constexpr (!std::is_same_v<T, sonopose_FusedPose>) {
        if (!dds::ext::is_alive(info)) forget(sample);
      }
    };
    dds::ext::try_take_each(reader, on_data, [&](const T& key, const dds::sub::SampleInfo& info) {
      if (!dds::ext::is_alive(info)) forget(key);
    });
  }

  void on_liveliness_changed(dds::sub::DataReader<T>& /*reader*/,
                             const dds::core::status::LivelinessChangedStatus& status) noexcept override {
    if (std::is_same_v<T, sonopose_FusedPose> && status.not_alive_count_change() > 0) {
      observers_.on_pose_writer_lost(status.last_publication_handle());
    }
  }

  void on_requested_deadline_missed(
      dds::sub::DataReader<T>& reader,
      const dds::core::status::RequestedDeadlineMissedStatus& status) noexcept override {
    if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
      T key{};
      if (dds::ext::try_key_value(reader, key, status.last_instance_handle()) < 0) return;
      observers_.on_deadline_missed(key.address, static_cast<std::uint64_t>(status.total_count_change()));
    }
  }

protected:
  virtual bool accepts(const dds::sub::DataReader<T>& /*reader*/, const Native& /*sample*/,
                       const dds::sub::SampleInfo& /*info*/) noexcept {
    return true;
  }
  virtual void on_sample(const Native& /*sample*/) noexcept {}
  virtual void on_gone(const T& /*key*/) noexcept {}

private:
  void forget(const T& key) {
    observers_.on_gone(key);
    on_gone(key);
  }

  BeaconObservers& observers_;
};

}  // namespace sonopose::observation
