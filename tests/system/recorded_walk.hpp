#pragma once
/// \file
/// Recordings of the simulator's walk.

#include "bus_log/recorded.hpp"
#include "sim/simulator.hpp"

#include <cstdint>
#include <filesystem>
#include <variant>
#include <vector>

namespace sonopose::test {

/// Samples of a walk, with the publication times that a bridge gives to IMU samples.
inline std::vector<Event> walk(double duration_s) {
  auto events = sim::record(sim::find_scenario("walk"), {.duration_s = duration_s}).events;
  for (Event& event : events) {
    const TimeNs now_ns = available_at_ns(event);
    if (auto* const imu = std::get_if<ImuSample>(&event)) imu->bridge_time_ns = now_ns;
  }
  return events;
}

/// Records these beacons with the same samples; returns those of one.
inline std::vector<Event> record_walk(const std::filesystem::path& file, double duration_s,
                                      const std::vector<BeaconAddress>& addresses) {
  const auto events = walk(duration_s);
  BusRecording recording(file);
  for (Event event : events) {
    for (const BeaconAddress address : addresses) {
      std::visit([address](auto& sample) { sample.address = address; }, event);
      recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
    }
  }
  return events;
}

/// Records twenty seconds of IMU samples and poses of three beacons; a pose has the number of its sample.
inline void record_imu_and_poses(const std::filesystem::path& file) {
  const auto events = sim::record(sim::find_scenario("walk"), {.duration_s = 20.0}).events;
  BusRecording recording(file);
  for (const Event& event : events) {
    const auto* const imu = std::get_if<ImuSample>(&event);
    if (imu == nullptr) continue;
    const auto log_time_ns = static_cast<std::uint64_t>(available_at_ns(event));
    for (BeaconAddress address = 7; address <= 9; ++address) {
      ImuSample sample = *imu;
      sample.address = address;
      recording.write(sample, log_time_ns);
      FusedPose pose;
      pose.address = address;
      pose.sequence = sample.sequence;
      recording.write(dds::topics::pose, dds::topics::to_idl(pose), log_time_ns);
    }
  }
}

}  // namespace sonopose::test
