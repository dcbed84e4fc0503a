#pragma once
// Latency of poses that the relay publishes as Odometry. The message has only the stamp of the pose; the
// native pose with that stamp provides the rest.

#include "chains.hpp"
#include "clocks/clocks.hpp"
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <map>
#include <mutex>
#include <vector>

namespace sonopose::benchmarks {

class Ros2LatencyCollector final : public dds::sub::NoOpDataReaderListener<sonopose_FusedPose>,
                                   public dds::sub::NoOpDataReaderListener<ros2::Odometry> {
public:
  void on_data_available(dds::sub::DataReader<sonopose_FusedPose>& reader) noexcept override {
    const std::lock_guard lock(mutex_);
    dds::ext::try_take_each(reader, [this](const sonopose_FusedPose& pose, const dds::sub::SampleInfo&) {
      poses_[pose.time] = pose;
    });
  }
  void on_data_available(dds::sub::DataReader<ros2::Odometry>& reader) noexcept override {
    const TimeNs received_ns = clocks::host_now();
    const std::lock_guard lock(mutex_);
    dds::ext::try_take_each(reader, [&](const ros2::Odometry& odometry, const dds::sub::SampleInfo&) {
      received_ns_[ros2::from_ros(odometry.header.stamp).value_or(0)] = received_ns;
    });
  }

  /// Latencies of the poses that have arrived in both forms.
  std::vector<Latency> taken() {
    const std::lock_guard lock(mutex_);
    std::vector<Latency> latencies;
    for (const auto& [stamp_ns, received_ns] : received_ns_) {
      const auto pose = poses_.find(stamp_ns);
      if (pose == poses_.end()) continue;
      latencies.push_back({seconds_between(pose->second.imu_bridge_time, pose->second.fusion_in_time),
                           seconds_between(pose->second.fusion_in_time, pose->second.fusion_out_time),
                           seconds_between(pose->second.fusion_out_time, received_ns)});
    }
    poses_.clear();
    received_ns_.clear();
    return latencies;
  }

private:
  std::mutex mutex_;
  std::map<TimeNs, sonopose_FusedPose> poses_;
  std::map<TimeNs, TimeNs> received_ns_;
};

}  // namespace sonopose::benchmarks
