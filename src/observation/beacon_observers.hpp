#pragma once
/// \file
/// Observations of all beacons, as needed by the monitor's table and the relay's diagnostics.

#include "clocks/clocks.hpp"
#include "observation/beacon_observer.hpp"
#include "observation/pose_writers.hpp"
#include "process/endpoint_counters.hpp"
#include "process/silence_detector.hpp"
#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/topics/conversions.hpp>

#include <map>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace sonopose::observation {

/// All beacons. Thread-safe: Cyclone's receive threads write, another thread reads.
class BeaconObservers {
public:
  explicit BeaconObservers(TimeNs pose_deadline_ns) : silences_(pose_deadline_ns) {}

  template <class Sample>
  void on(const Sample& sample) {
    const std::lock_guard lock(mutex_);
    observers_[sample.address].on(sample);
  }

  void on(const FusedPose& pose, TimeNs received_ns, dds::InstanceHandle writer) {
    const std::lock_guard lock(mutex_);
    pose_writers_[pose.address] = writer;
    served_.on(pose, writer);
    observers_[pose.address].on(pose, received_ns);
    silences_.on_sample(pose.address, clocks::steady_now());
  }

  void on(const FusionStatus& status, dds::InstanceHandle writer) {
    const std::lock_guard lock(mutex_);
    served_.on(status, writer);
    observers_[status.address].on(status);
  }

  void on_deadline_missed(BeaconAddress address, std::uint64_t count) {
    const std::lock_guard lock(mutex_);
    observers_[address].on_deadline_missed(count);
  }

  /// A pose writer lost its liveliness. The beacons that it wrote last are lost until another writer takes
  /// over.
  void on_pose_writer_lost(dds::InstanceHandle lost) {
    const std::lock_guard lock(mutex_);
    for (const auto& [address, writer] : pose_writers_) {
      if (writer == lost) observers_[address].on_pose_lost();
    }
  }

  /// An instance lost its last writer.
  void on_gone(const sonopose_FusedPose& key) {
    const std::lock_guard lock(mutex_);
    observers_[key.address].on_pose_lost();
  }
  void on_gone(const sonopose_FusionStatus& key) {
    const std::lock_guard lock(mutex_);
    observers_[key.address].on_fusion_gone(key.fusion_id);
  }
  template <class Other>
  void on_gone(const Other& /*key*/) {}

  /// Pose streams that fell silent or resumed since the last call.
  std::vector<process::SilenceDetector::Change> silence_changes() {
    std::vector<process::SilenceDetector::Change> changes;
    const std::lock_guard lock(mutex_);
    silences_.find_changes(clocks::steady_now(), changes);
    return changes;
  }

  ServedBeacons served() {
    const std::lock_guard lock(mutex_);
    return served_;
  }

  /// BeaconObserver::take_window of each beacon, ordered by address.
  std::vector<BeaconView> take_windows(TimeNs now_ns) {
    const std::lock_guard lock(mutex_);
    std::vector<BeaconView> views;
    for (auto& [address, observer] : observers_) views.push_back(observer.take_window(address, now_ns));
    return views;
  }

  /// BeaconObserver::summary of each beacon, ordered by address.
  std::vector<BeaconView> summaries(TimeNs now_ns) {
    const std::lock_guard lock(mutex_);
    std::vector<BeaconView> views;
    for (const auto& [address, observer] : observers_) views.push_back(observer.summary(address, now_ns));
    return views;
  }

private:
  std::mutex mutex_;
  std::map<BeaconAddress, BeaconObserver> observers_;
  std::map<BeaconAddress, dds::InstanceHandle> pose_writers_;
  ServedBeacons served_;
  process::SilenceDetector silences_;
};

/// Passes the samples and statuses of one topic to the observers. A derived class may override `on_sample`,
/// which is called for each sample first.
template <class T>
class ObservingListener : public process::CountingReaderListener<T> {
public:
  using Native = decltype(dds::topics::from_idl(std::declval<const T&>()));

  ObservingListener(BeaconObservers& observers, process::EndpointCounters& endpoints)
      : process::CountingReaderListener<T>(endpoints), observers_(observers) {}

  void on_data_available(dds::DataReader<T>& reader) noexcept override {
    const TimeNs received_ns = clocks::host_now();
    const auto on_data = [&](const T& sample, const dds::SampleInfo& info) {
      const Native native = dds::topics::from_idl(sample);
      on_sample(native);
      if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
        observers_.on(native, received_ns, info.publication_handle());
      } else if constexpr (std::is_same_v<T, sonopose_FusionStatus>) {
        observers_.on(native, info.publication_handle());
      } else {
        observers_.on(native);
      }
    };
    reader.try_take_each(on_data, [&](const T& key, const dds::SampleInfo& info) {
      if (!info.alive()) observers_.on_gone(key);
    });
  }

  void on_liveliness_changed(dds::DataReader<T>& /*reader*/,
                             const dds::LivelinessChangedStatus& status) noexcept override {
    if (std::is_same_v<T, sonopose_FusedPose> && status.not_alive_count_change > 0) {
      observers_.on_pose_writer_lost({status.last_publication_handle});
    }
  }

  void on_requested_deadline_missed(dds::DataReader<T>& reader,
                                    const dds::RequestedDeadlineMissedStatus& status) noexcept override {
    if constexpr (std::is_same_v<T, sonopose_FusedPose>) {
      T key{};
      if (reader.try_key_value(key, {status.last_instance_handle}) < 0) return;
      observers_.on_deadline_missed(key.address, static_cast<std::uint64_t>(status.total_count_change));
    }
  }

protected:
  virtual void on_sample(const Native& /*sample*/) noexcept {}

private:
  BeaconObservers& observers_;
};

}  // namespace sonopose::observation
