#include "bridge/bridge_publisher.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include "process/host_clock.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace sonopose::bridge {

void BridgeNode::Publisher::tick() {
  flush();
  const TimeNs now = process::steady_now_ns();
  if (now >= status_due_ns_) publish_statuses(now);
}

void BridgeNode::Publisher::publish_statuses(TimeNs now) {
  constexpr TimeNs period_ns = 1'000'000'000;
  others_.look(status_writer_.instance_handle(),
               [this](BeaconAddress address) { return beacons_.contains(address); });
  for (auto& entry : beacons_) publish_status(entry.second, now);
  status_last_ns_ = now;
  status_due_ns_ = now + period_ns;
  log_unwritten();
}

void BridgeNode::Publisher::log_unwritten() {
  if (unwritten_ != unwritten_reported_) {
    fmt::print(stderr, "sonopose-bridge: {} samples could not be written: a reader is too slow\n",
               unwritten_ - unwritten_reported_);
    unwritten_reported_ = unwritten_;
  }
}

void BridgeNode::Publisher::publish_status(Beacon& beacon, TimeNs now_steady_ns) {
  const double elapsed_s = seconds_between(status_last_ns_, now_steady_ns);
  const auto rate_hz = [elapsed_s](Stream& stream) {
    const auto samples = static_cast<double>(std::exchange(stream.samples, 0));
    return elapsed_s > 0.0 ? samples / elapsed_s : 0.0;
  };
  BeaconStatus& status = beacon.status;
  status.time_ns = process::now_ns();
  status.imu_rate_hz = rate_hz(beacon.imu);
  status.fix_rate_hz = rate_hz(beacon.fix);
  status.heading_rate_hz = rate_hz(beacon.heading);
  status.other_bridges = others_.count(status.address);
  status.imu_deadlines_missed = beacon.imu.deadlines.count(now_steady_ns);
  status.fix_deadlines_missed = beacon.fix.deadlines.count(now_steady_ns);
  status.heading_deadlines_missed = beacon.heading.deadlines.count(now_steady_ns);
  status.liveliness_lost = ends_.liveliness_lost;
  status.readers_incompatible = ends_.incompatible_qos;
  status.samples_unwritten = unwritten_;
  write(status_writer_, dds::to_idl(beacon.status));
}

}  // namespace sonopose::bridge
