#pragma once
// A healthy system as the doctor sees it, for tests that make one thing wrong.

#include <sonopose/samples/pose.hpp>
#include "doctor/rules/doctor.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace sonopose::doctor::test {

inline EndpointObservation endpoint(const std::string& topic, const std::string& type, const std::string& process,
                             const dds::Qos& qos = {}) {
  return {topic, type, qos, {process, "rover", 100}};
}

inline dds::Qos exclusive(std::int32_t strength = 100) {
  return dds::Qos() << dds::policy::Ownership{dds::policy::OwnershipKind::exclusive}
                    << dds::policy::OwnershipStrength{strength};
}

inline BeaconObservation healthy_beacon() {
  BeaconObservation beacon;
  beacon.address = 7;
  beacon.imu = {300, 100.0, 0.02, 0.1};
  beacon.fix = {24, 8.0, 0.15, 2.5};
  beacon.heading = {24, 8.0, 0.15, 2.5};
  beacon.pose = {300, 100.0, 0.02, 0.1};
  beacon.valid_headings = 24;
  beacon.bridge_ahead_s = -0.0005;
  beacon.bridges = {{"sonopose-bridge", "rover", 100}};
  BeaconStatus status;
  status.battery_v = 3.9;
  status.clock_jitter_s = 0.002;
  beacon.status_before = status;
  beacon.status = status;
  beacon.fusion_before = FusionStatus{};
  beacon.fusion = FusionStatus{};
  RestObservation rest;
  rest.mean_force_body_mps2 = {0.05, -0.1, 9.8};
  rest.force_std_mps2 = 0.03;
  rest.rate_std_radps = 0.003;
  rest.fixes_span_m = 0.05;
  beacon.imu_means = rest;
  return beacon;
}

inline Observations healthy() {
  Observations seen;
  seen.window_s = 3;
  seen.own_host = "rover";
  seen.bus.domain_id = 5;
  seen.native_topics = {{"sonopose/imu", "sonopose::ImuSample"}, {"sonopose/pose", "sonopose::FusedPose"}};
  seen.writers = {endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-bridge"),
                  endpoint("sonopose/pose", "sonopose::FusedPose", "sonopose-fusion", exclusive())};
  seen.readers = {endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-fusion"),
                  endpoint("sonopose/pose", "sonopose::FusedPose", "consumer", exclusive())};
  seen.beacons = {healthy_beacon()};
  return seen;
}

/// The worst of what is found with one text in what it says; `ok` where there is none.
inline Finding found(const std::vector<Finding>& findings, const std::string& text) {
  Finding worst;
  for (const Finding& finding : findings) {
    if (finding.what.find(text) != std::string::npos && finding.severity >= worst.severity) worst = finding;
  }
  return worst;
}

/// What is found in a system with the beacon changed by `change`.
template <class Change>
std::vector<Finding> findings_with(const Change& change) {
  Observations seen = healthy();
  change(seen.beacons.front());
  return diagnose(seen);
}

}  // namespace sonopose::doctor::test
