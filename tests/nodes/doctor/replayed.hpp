#pragma once
// Observations of a simulated or recorded beacon and its fusion, without processes.

#include "doctor/probe/beacon_probe.hpp"
#include "doctor/rules/healthy_system.hpp"
#include "fusion/beacon_estimator.hpp"
#include "sim/simulator.hpp"
#include "support/events.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sonopose::doctor::test {

/// Time and length of a run of the doctor, in seconds after the first event.
struct Look {
  double begin_s = 8;
  double window_s = 8;
};

/// Observations of the doctor if this is the only beacon.
inline rules::Observations observed(const std::vector<Event>& events, const settings::Settings& settings,
                                    const Look& look) {
  fusion::BeaconEstimator estimator(7, fusion::SettingsTimeline(config::BeaconSettings(settings)), false);
  probe::BeaconProbe probe;
  const TimeNs begin_ns = available_at_ns(events.front()) + to_ns(look.begin_s);
  const TimeNs end_ns = begin_ns + to_ns(look.window_s);
  bool is_looking = false;
  rules::Observations observations = rules::test::healthy();
  const rules::BeaconObservation healthy = observations.beacons.front();
  const probe::Deadlines deadlines{.imu_s = healthy.imu.deadline_s,
                                   .fix_s = healthy.fix.deadline_s,
                                   .heading_s = healthy.heading.deadline_s,
                                   .pose_s = healthy.pose.deadline_s};
  const auto publish_statuses = [&] {
    probe.on(estimator.status());
    probe.on(*healthy.status);
  };
  for (const Event& event : events) {
    const TimeNs now_ns = available_at_ns(event);
    if (now_ns >= end_ns) break;
    if (now_ns >= begin_ns && !std::exchange(is_looking, true)) {
      probe.begin(begin_ns, deadlines);
      publish_statuses();
    }
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      ImuSample sample = *imu;
      sample.bridge_time_ns = now_ns;
      probe.on(sample, now_ns, 1);
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      probe.on(*fix, now_ns);
    } else if (const auto* heading = std::get_if<PairHeading>(&event)) {
      probe.on(*heading, now_ns);
    } else {
      probe.on(std::get<TwistSample>(event), now_ns);
    }
    estimator.collate(event, 1, {now_ns}, {now_ns});
    while (const auto outcome = estimator.process_next()) {
      if (const auto* pose = std::get_if<FusedPose>(&outcome->result)) probe.on(*pose, now_ns);
      if (const auto* report = std::get_if<FixReport>(&outcome->result)) probe.on(*report, now_ns);
    }
  }
  publish_statuses();
  observations.window_s = look.window_s;
  rules::BeaconObservation& beacon = observations.beacons.front();
  beacon = probe.observation(end_ns, settings);
  beacon.pieces = probe.pieces(settings);
  beacon.address = healthy.address;
  beacon.bridges = healthy.bridges;
  return observations;
}

/// Events of a scenario with changed sensors.
template <class Change>
std::vector<Event> events_of(const std::string& scenario, std::uint64_t seed, double duration_s,
                             const Change& change) {
  const sim::Run run{.seed = seed, .duration_s = duration_s};
  sim::Scenario drawn = sim::drawn(sim::find_scenario(scenario), run);
  change(drawn.sensors);
  return sim::record(drawn, run).events;
}

inline std::vector<Event> events_of(const std::string& scenario, std::uint64_t seed, double duration_s) {
  return events_of(scenario, seed, duration_s, [](auto&) {});
}

/// Changes the sign of one axis of the accelerometer.
inline void invert_axis(std::vector<Event>& events, Eigen::Index axis) {
  for (auto* imu : sonopose::test::each<ImuSample>(events)) imu->specific_force_body_mps2(axis) *= -1.0;
}

/// Warnings and errors as text, one per line.
inline std::string problems_of(const rules::Observations& observations) {
  std::string text;
  for (const rules::Finding& finding : diagnose(observations)) {
    if (finding.severity >= rules::Severity::warning) text += finding.what + "; " + finding.remedy + '\n';
  }
  return text;
}

}  // namespace sonopose::doctor::test
