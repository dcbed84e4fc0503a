#pragma once
// Events of a simulated beacon, and engines that are fed with them and whose output is kept.

#include "fusion/beacon_estimators.hpp"
#include "sim/simulator.hpp"
#include "support/bits.hpp"

#include <algorithm>
#include <iterator>
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

/// Feeds engines and keeps what they make.
struct Feeder {
  explicit Feeder(bool lossless, config::FusionConfig config = {}) : engines(std::move(config), lossless) {}

  /// An event that arrived when it became available.
  void push(const Event& event) { push(event, SteadyTime{available_at_ns(event)}); }
  void push(const Event& event, SteadyTime arrival) {
    engines.push(
        event, arrival, [this](const FusedPose& pose) { poses.push_back(pose); },
        [this](const FixReport& report) { reports.push_back(report); },
        [this](const SettingsInForce& change) { changes.push_back(change); });
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

  [[nodiscard]] std::vector<SettingsInForce> changes_of(BeaconAddress address) const {
    std::vector<SettingsInForce> found;
    std::copy_if(changes.begin(), changes.end(), std::back_inserter(found),
                 [address](const SettingsInForce& change) { return change.address == address; });
    return found;
  }

  BeaconEstimators engines;
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
  std::vector<SettingsInForce> changes;
};

inline bool same(const std::vector<FusedPose>& a, const std::vector<FusedPose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FusedPose& x, const FusedPose& y) {
    return sonopose::test::bits_of(x) == sonopose::test::bits_of(y);
  });
}

/// What a bare engine makes of the events, if it is given `settings` before event number `from`.
inline std::vector<FusedPose> poses_of_engine(const std::vector<Event>& events,
                                              const settings::Settings& settings = {},
                                              std::uint64_t from = UINT64_MAX) {
  estimation::documented::Engine engine{settings::Settings{}};
  std::vector<FusedPose> poses;
  for (const Event& event : events) {
    if (sequence_of(event) == from) engine.configure(settings);
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      if (const auto pose = engine.on(*imu)) poses.push_back(*pose);
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      engine.on(*fix);
    } else {
      engine.on(std::get<PairHeading>(event));
    }
  }
  return poses;
}

}  // namespace sonopose::fusion::test
