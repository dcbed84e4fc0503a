#pragma once
/// \file
/// Artificial histories that keep and break the rules.

#include "faults/history_checker.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::faults::artificial {

inline constexpr BeaconAddress beacon = 7;
inline constexpr TimeNs host_zero_ns = 1'700'000'000'000'000'000;  // host time at steady time 0
inline constexpr TimeNs ms = 1'000'000;
inline constexpr TimeNs period_ns = 5 * ms;

constexpr SteadyTime at(double time_s) {
  return {to_ns(time_s)};
}

/// Id of the process of the fusion with this strength.
constexpr ProcessId process_of(std::int32_t strength) {
  return static_cast<ProcessId>(strength);
}

/// The pose of the IMU sample that left the bridge at `sent`, received 0.5 ms later.
inline Arrival pose_at(SteadyTime sent, std::int32_t strength = 300) {
  Arrival pose;
  pose.received = sent + ms / 2;
  pose.received_host_ns = host_zero_ns + pose.received.ns;
  pose.process = process_of(strength);
  pose.writer = process_of(strength);
  pose.strength = strength;
  pose.address = beacon;
  pose.time_ns = host_zero_ns + sent.ns - ms;
  pose.bridge_time_ns = host_zero_ns + sent.ns;
  return pose;
}

inline Published imu_at(SteadyTime sent) {
  return {sent, beacon, static_cast<std::uint64_t>(sent.ns / period_ns), host_zero_ns + sent.ns};
}

inline FusionReport report_at(double time_s, std::int32_t strength) {
  FusionReport report{at(time_s), process_of(strength), {}};
  report.status.address = beacon;
  report.status.strength = strength;
  report.status.role = FusionRole::serving;
  return report;
}

/// fusion-300 serves at 200 Hz from 5 s to 10 s, fusion-200 stands by; the line has garbage at 6 s.
inline History undisturbed() {
  History history;
  history.plan.fusions = 2;
  history.end = at(10);
  history.imu_period_ns = period_ns;
  for (SteadyTime sent = at(5); sent < at(10); sent += period_ns) {
    history.imu.push_back(imu_at(sent));
    history.poses.push_back(pose_at(sent));
  }
  history.statuses = {report_at(4.5, 300), report_at(4.5, 200), report_at(9.5, 300), report_at(9.5, 200)};
  history.episodes = {{{.fault = Fault::garbage}, {at(6), at(6.2)}}};
  history.lives = {{Role::bridge, {at(1)}}, {Role::first_fusion, {at(1)}}, {Role::second_fusion, {at(1)}}};
  return history;
}

inline void erase_poses(History& history, double from_s, double until_s) {
  std::erase_if(history.poses, [&](const Arrival& pose) {
    return pose.received >= at(from_s) && pose.received < at(until_s);
  });
}

inline void erase_imu(History& history, double from_s, double until_s) {
  std::erase_if(history.imu, [&](const Published& imu) {
    return imu.received >= at(from_s) && imu.received < at(until_s);
  });
}

/// Makes fusion-200 serve from `from_s` on.
inline void pass_on(History& history, double from_s) {
  for (Arrival& pose : history.poses) {
    if (pose.received >= at(from_s)) pose.process = pose.writer = process_of(pose.strength = 200);
  }
}

/// fusion-300 is killed at 7 s, the consumer learns it 100 ms later, and fusion-200 is received from
/// `until_s` on.
inline History takeover(double until_s) {
  History history = undisturbed();
  erase_poses(history, 7, until_s);
  pass_on(history, 7);
  history.losses.push_back({at(7.1), process_of(300)});
  history.lives[1].interval.until = at(7);
  history.episodes.push_back({{.fault = Fault::kill, .target = Role::first_fusion}, {at(7), at(7.3)}});
  return history;
}

/// First pose received at or after `time_s`.
inline Arrival& pose_after(History& history, double time_s) {
  return *std::find_if(history.poses.begin(), history.poses.end(),
                       [&](const Arrival& pose) { return pose.received >= at(time_s); });
}

using Violations = std::vector<std::string>;
inline const Violations none;

inline Violations violations_of(const History& history) {
  return HistoryChecker(history).check().violations;
}

}  // namespace sonopose::faults::artificial
