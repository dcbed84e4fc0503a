#pragma once
// Observations of a healthy system, for tests that change one detail.

#include "doctor/rules/diagnosis.hpp"
#include <sonopose/samples/pose.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace sonopose::doctor::rules::test {

inline EndpointObservation endpoint(const std::string& topic, const std::string& type,
                                    const std::string& process, const dds::Qos& qos = {}) {
  return {topic, type, qos, {process, "rover", 100}};
}

inline dds::Qos exclusive(std::int32_t strength = 100) {
  return dds::Qos() << dds::policy::Ownership::Exclusive() << dds::policy::OwnershipStrength(strength);
}

inline BeaconObservation healthy_beacon() {
  BeaconObservation beacon;
  beacon.address = 7;
  beacon.imu = {300, 100.0, 0.02, 0.1};
  beacon.fix = {24, 8.0, 0.15, 2.5};
  beacon.heading = {24, 8.0, 0.15, 2.5};
  beacon.pose = {300, 100.0, 0.02, 0.1};
  beacon.pair_headings = beacon.valid_pair_headings = 24;
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
  beacon.rest = rest;
  return beacon;
}

inline Observations healthy() {
  Observations observations;
  observations.window_s = 3;
  observations.own_host = "rover";
  observations.bus.domain_id = 5;
  observations.native_topics = {{"sonopose/imu", "sonopose::ImuSample"},
                                {"sonopose/pose", "sonopose::FusedPose"}};
  observations.writers = {endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-bridge"),
                          endpoint("sonopose/pose", "sonopose::FusedPose", "sonopose-fusion", exclusive())};
  observations.readers = {endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-fusion"),
                          endpoint("sonopose/pose", "sonopose::FusedPose", "consumer", exclusive())};
  observations.beacons = {healthy_beacon()};
  return observations;
}

/// Most severe finding whose sentence contains `text`; severity `ok` if there is none.
inline Finding found(const std::vector<Finding>& findings, const std::string& text) {
  Finding worst;
  for (const Finding& finding : findings) {
    if (finding.what.find(text) != std::string::npos && finding.severity >= worst.severity) worst = finding;
  }
  return worst;
}

/// Findings in a healthy system whose beacon `change` has modified.
template <class Change>
std::vector<Finding> findings_with(const Change& change) {
  Observations observations = healthy();
  change(observations.beacons.front());
  return diagnose(observations);
}

}  // namespace sonopose::doctor::rules::test
