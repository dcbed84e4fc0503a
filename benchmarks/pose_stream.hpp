#pragma once
// A consumer of the poses of many beacons, and its counters.

#include "clocks/clocks.hpp"
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/samples.hpp>

#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace sonopose::benchmarks {

/// The poses of a time span.
struct PoseCount {
  std::vector<double>
      latencies_s;            ///< latency from the bridge's publication to the receipt here, one per pose
  std::uint64_t missing = 0;  ///< IMU periods without a pose
};

/// Takes poses of any number of beacons whose IMUs have the same known rate and no losses.
class PoseStream final : public dds::sub::NoOpDataReaderListener<sonopose_FusedPose> {
public:
  explicit PoseStream(double imu_rate_hz) : imu_rate_hz_(imu_rate_hz), last_ns_(65536) {}

  void on_data_available(dds::sub::DataReader<sonopose_FusedPose>& reader) noexcept override {
    const TimeNs received_ns = clocks::host_now();
    const std::lock_guard lock(mutex_);
    dds::ext::try_take_each(
        reader, [&](const sonopose_FusedPose& pose, const dds::sub::SampleInfo&) { on(pose, received_ns); });
  }

  PoseCount taken() {
    const std::lock_guard lock(mutex_);
    return std::exchange(count_, {});
  }

  /// Number of beacons with a pose so far.
  std::size_t beacons() {
    const std::lock_guard lock(mutex_);
    return beacons_;
  }

private:
  void on(const sonopose_FusedPose& pose, TimeNs received_ns) {
    count_.latencies_s.push_back(seconds_between(pose.imu_bridge_time, received_ns));
    TimeNs& last_ns = last_ns_[pose.address];
    if (last_ns == 0) {
      ++beacons_;
    } else {
      const auto periods = std::llround(seconds_between(last_ns, pose.imu_sensor_time) * imu_rate_hz_);
      if (periods > 1) count_.missing += static_cast<std::uint64_t>(periods - 1);
    }
    last_ns = pose.imu_sensor_time;
  }

  double imu_rate_hz_;
  std::mutex mutex_;
  PoseCount count_;
  std::vector<TimeNs> last_ns_;  ///< sensor time of the latest pose by address; 0: none yet
  std::size_t beacons_ = 0;
};

/// Counts the lost events that fusions report.
class LostEvents final : public dds::sub::NoOpDataReaderListener<sonopose_FusionStatus> {
public:
  void on_data_available(dds::sub::DataReader<sonopose_FusionStatus>& reader) noexcept override {
    const std::lock_guard lock(mutex_);
    dds::ext::try_take_each(reader, [this](const sonopose_FusionStatus& status, const dds::sub::SampleInfo&) {
      by_address_[status.address] = status.events_lost;
    });
  }

  std::uint64_t sum() {
    const std::lock_guard lock(mutex_);
    std::uint64_t lost = 0;
    for (const auto& entry : by_address_) lost += entry.second;
    return lost;
  }

private:
  std::mutex mutex_;
  std::map<BeaconAddress, std::uint64_t> by_address_;
};

}  // namespace sonopose::benchmarks
