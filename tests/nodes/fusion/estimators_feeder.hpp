#pragma once
// Events of a simulated beacon, and estimators that process them.

#include "fusion/beacon_estimators.hpp"
#include "fusion/settings_requests.hpp"
#include "sim/simulator.hpp"
#include "support/bits.hpp"
#include "threads/guarded.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::fusion::test {

inline constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;

inline std::vector<Event> walk(BeaconAddress address, double duration_s, TimeNs start_ns = begin_ns) {
  sim::Simulator simulator(
      sim::find_scenario("walk"), {},
      {.seed = 1, .start_time_ns = start_ns, .address = address, .duration_s = duration_s});
  std::vector<Event> events;
  while (const auto step = simulator.next()) events.push_back(step->event);
  return events;
}

inline SettingsRequest request(BeaconAddress address, std::vector<SettingAssignment> assignments,
                               std::uint64_t from_sequence = 0, std::uint64_t id = 0) {
  return {.address = address,
          .request_id = id,
          .from_sequence = from_sequence,
          .assignments = std::move(assignments)};
}

inline settings::Settings settings_of(settings::EngineKind engine) {
  settings::Settings settings;
  settings.engine.engine = engine;
  return settings;
}

inline config::FusionConfig config_of(settings::EngineKind engine) {
  config::FusionConfig config;
  config.assign("fusion.engine=" +
                std::string(engine == settings::EngineKind::kalman ? "kalman" : "documented"));
  return config;
}

/// Settings of the documented engine, which reads every setting, so that each change has an effect.
inline settings::Settings documented() {
  return settings_of(settings::EngineKind::documented);
}

inline config::FusionConfig documented_config() {
  return config_of(settings::EngineKind::documented);
}

/// Feeds estimators and records their output.
struct Feeder {
  explicit Feeder(bool lossless, const config::FusionConfig& config = documented_config())
      : estimators(config, lossless) {}

  std::optional<FusionStatus> status(BeaconAddress address) {
    return estimators.with([&](auto& all) {
      BeaconEstimator* const estimator = all.find(address);
      return estimator == nullptr ? std::nullopt : std::optional(estimator->status());
    });
  }
  Estimate estimate(BeaconAddress address) {
    return estimators.with([&](auto& all) { return all.find(address)->estimate(); });
  }
  void reset(BeaconAddress address, std::uint64_t request_id = 0) {
    estimators.with([&](auto& all) { all.reset(address, request_id); });
  }
  SettingsChange settings_for_all() {
    return estimators.with([](auto& all) { return all.settings_for_all(); });
  }

  /// Pushes an event that arrived when it became available.
  void push(const Event& event) { push(event, SteadyTime{available_at_ns(event)}); }
  void push(const Event& event, SteadyTime arrival) {
    const auto estimator = estimators.with([&](auto& all) { return all.find_or_make(address_of(event)); });
    estimator->collate(event, 0, arrival, arrival);
    while (const auto outcome = estimator->process_next()) {
      if (outcome->settings_changed) changes.push_back(*estimator->take_settings_change());
      if (const auto* pose = std::get_if<FusedPose>(&outcome->result)) poses.push_back(*pose);
      if (const auto* report = std::get_if<FixReport>(&outcome->result)) reports.push_back(*report);
    }
  }
  void push_all(const std::vector<Event>& events) {
    for (const Event& event : events) push(event);
  }

  [[nodiscard]] std::vector<FusedPose> poses_of(BeaconAddress address) const {
    std::vector<FusedPose> found;
    std::copy_if(poses.begin(), poses.end(), std::back_inserter(found),
                 [address](const FusedPose& pose) { return pose.address == address; });
    return found;
  }

  [[nodiscard]] std::vector<SettingsChange> changes_of(BeaconAddress address) const {
    std::vector<SettingsChange> found;
    std::copy_if(changes.begin(), changes.end(), std::back_inserter(found),
                 [address](const SettingsChange& change) { return change.address == address; });
    return found;
  }

  threads::Guarded<BeaconEstimators> estimators;
  SettingsRequests requests{estimators};
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
  std::vector<SettingsChange> changes;
};

inline bool same(const std::vector<FusedPose>& a, const std::vector<FusedPose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FusedPose& x, const FusedPose& y) {
    return sonopose::test::bits_of(x) == sonopose::test::bits_of(y);
  });
}

/// Poses of a single estimator that is configured with `settings` before event number `from`.
inline std::vector<FusedPose> poses_of_estimator(const std::vector<Event>& events,
                                                 const settings::Settings& settings = documented(),
                                                 std::uint64_t from = UINT64_MAX) {
  estimation::AnyEstimator estimator{documented()};
  std::vector<FusedPose> poses;
  for (const Event& event : events) {
    if (sequence_of(event) == from) estimator.configure(settings);
    const auto output = estimation::process(estimator, event);
    if (const auto* pose = std::get_if<FusedPose>(&output)) poses.push_back(*pose);
  }
  return poses;
}

}  // namespace sonopose::fusion::test
