#pragma once
/// \file
/// What a process has seen of all beacons: the monitor's table, the relay's diagnostics.

#include "observation/beacon_view.hpp"
#include "process/clocks.hpp"
#include "process/endpoint_counters.hpp"
#include "process/silence_detector.hpp"
#include <sonopose/dds/binding/sample.hpp>
#include <sonopose/dds/topics/conversions.hpp>

#include <map>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace sonopose::observation {

/// All beacons; filled by Cyclone's threads, looked at by another one.
class BeaconObservers {
public:
  explicit BeaconObservers(TimeNs pose_deadline_ns) : silences_(pose_deadline_ns) {}

  template <class Sample>
  void on(const Sample& sample) {
    const std::lock_guard lock(mutex_);
    watches_[sample.address].on(sample);
  }

  void on(const FusedPose& pose, TimeNs received_ns, dds::InstanceHandle writer) {
    const std::lock_guard lock(mutex_);
    pose_writers_[pose.address] = writer;
    watches_[pose.address].on(pose, received_ns);
    silences_.on_sample(pose.address, process::steady_now());
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

  /// What pose streams fell silent or were heard again since the last call.
  std::vector<process::SilenceDetector::Change> silence_changes() {
    std::vector<process::SilenceDetector::Change> changes;
    const std::lock_guard lock(mutex_);
    silences_.find_changes(process::steady_now(), changes);
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
  std::map<BeaconAddress, BeaconObserver> watches_;
  std::map<BeaconAddress, dds::InstanceHandle> pose_writers_;
  process::SilenceDetector silences_;
};

/// Listens for one topic. `on_sample` hears of each sample besides.
template <class T>
class ObservingListener : public process::CountingReaderListener<T> {
public:
  using Native = decltype(dds::from_idl(std::declval<const T&>()));

  ObservingListener(BeaconObservers& watches, process::EndpointCounters& ends)
      : process::CountingReaderListener<T>(ends), watches_(watches) {}

  void on_data_available(dds::DataReader<T>& reader) noexcept override {
    const TimeNs received_ns = process::host_now();
    const auto on_data = [&](const T& sample, const dds::SampleInfo& info) {
      const Native native = dds::from_idl(sample);
      on_sample(native);
      if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
        watches_.on(native, received_ns, info.publication_handle());
      } else {
        watches_.on(native);
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

protected:
  virtual void on_sample(const Native& /*sample*/) noexcept {}

private:
  BeaconObservers& watches_;
};

}  // namespace sonopose::observation
