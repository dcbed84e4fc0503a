#include "bridge/bridge_publisher.hpp"
#include "process/clocks.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace sonopose::bridge {

void BridgeNode::Publisher::tick() {
  flush();
  const SteadyTime now = process::steady_now();
  if (now >= status_due_) publish_statuses(now);
}

void BridgeNode::Publisher::publish_statuses(SteadyTime now) {
  constexpr TimeNs period_ns = 1'000'000'000;
  others_.look(status_writer_.instance_handle(),
               [this](BeaconAddress address) { return beacons_.contains(address); });
  for (auto& entry : beacons_) publish_status(entry.second, now);
  status_last_ = now;
  status_due_ = now + period_ns;
  log_unwritten();
}

void BridgeNode::Publisher::log_unwritten() {
  if (unwritten_ != unwritten_reported_) {
    fmt::print(stderr, "sonopose-bridge: {} samples could not be written: a reader is too slow\n",
               unwritten_ - unwritten_reported_);
    unwritten_reported_ = unwritten_;
  }
}

void BridgeNode::Publisher::publish_status(Beacon& beacon, SteadyTime now) {
  const double elapsed_s = seconds_between(status_last_, now);
  const auto rate_hz = [elapsed_s](Stream& stream) {
    const auto samples = static_cast<double>(std::exchange(stream.samples, 0));
    return elapsed_s > 0.0 ? samples / elapsed_s : 0.0;
  };
  BeaconStatus& status = beacon.status;
  status.time_ns = process::host_now();
  status.imu_rate_hz = rate_hz(beacon.imu);
  status.fix_rate_hz = rate_hz(beacon.fix);
  status.heading_rate_hz = rate_hz(beacon.heading);
  status.other_bridges = others_.count(status.address);
  status.imu_deadlines_missed = beacon.imu.deadlines.count(now);
  status.fix_deadlines_missed = beacon.fix.deadlines.count(now);
  status.heading_deadlines_missed = beacon.heading.deadlines.count(now);
  status.liveliness_lost = ends_.liveliness_lost;
  status.readers_incompatible = ends_.incompatible_qos;
  status.samples_unwritten = unwritten_;
  write(status_writer_, dds::to_idl(beacon.status));
}

}  // namespace sonopose::bridge
