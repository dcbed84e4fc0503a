#include "doctor/replayed.hpp"
#include "support/events.hpp"
#include "support/matches.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <random>

namespace tracks_test {

using namespace sonopose;
using namespace sonopose::doctor::rules;
using namespace sonopose::doctor::rules::test;
using namespace sonopose::doctor::test;
using Catch::Contains;

/// Moves a random share of the fixes.
void displace(std::vector<Event>& events, double share, const Vector3d& by_world_m, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution is_displaced(share);
  for (auto* fix : sonopose::test::each<UltrasonicFix>(events)) {
    if (is_displaced(random)) fix->position_world_m += by_world_m;
  }
}

TEST_CASE("Fixes of a second, wrong track are found, with its place") {
  for (const char* const scenario : {"walk", "forklift", "kart"}) {
    for (const double share : {0.1, 0.3}) {
      CAPTURE(scenario, share);
      auto events = events_of(scenario, 1931, 18.5);
      displace(events, share, {0.9, -1.2, 0}, 5);
      const std::string problems = problems_of(observed(events, {}, {10, 8}));
      CAPTURE(problems);
      const auto match = sonopose::test::first_match(problems, "on a second track, ([0-9.]+) m off");
      REQUIRE_FALSE(match.empty());
      CHECK(std::stod(match[1]) == Approx(1.5).margin(0.15));
    }
  }
}

TEST_CASE("Faults of all fixes are named, and none of their consequences") {
  struct Fault {
    const char* finding;
    std::function<void(UltrasonicFix&, int)> change;
  };
  Vector3d last_m = Vector3d::Zero();
  const std::vector<Fault> faults{
      {"the positions accelerate by more than", [](UltrasonicFix& fix, int) { fix.position_world_m *= 1e3; }},
      {"fixes are 0.00 0.00 0.00 m, a default position",
       [](UltrasonicFix& fix, int i) {
         if (i % 3 == 0) fix.position_world_m.setZero();
       }},
      {"fixes repeat the position of the one before", [&](UltrasonicFix& fix, int i) {
         if (i % 4 == 0) last_m = fix.position_world_m;
         fix.position_world_m = last_m;
       }}};
  for (const char* const scenario : {"walk", "forklift", "kart"}) {
    for (const Fault& fault : faults) {
      auto events = events_of(scenario, 1931, 18.5);
      int i = 0;
      for (auto* fix : sonopose::test::each<UltrasonicFix>(events)) fault.change(*fix, i++);
      const std::string problems = problems_of(observed(events, {}, {10, 8}));
      CAPTURE(scenario, problems);
      CHECK_THAT(problems, Contains(fault.finding));
      CHECK(std::count(problems.begin(), problems.end(), '\n') == 1);
    }
  }
}

TEST_CASE("A few default positions hide no wrong mount") {
  auto events = events_of("walk", 1931, 18.5);
  int i = 0;
  for (auto* fix : sonopose::test::each<UltrasonicFix>(events)) {
    if (++i % 15 == 0) fix->position_world_m.setZero();
  }
  settings::Settings settings;
  settings.heading.mount_offset_deg = 90;
  const std::string problems = problems_of(observed(events, settings, {10, 8}));
  CHECK_THAT(problems, Contains("fixes are 0.00 0.00 0.00 m, a default position") &&
                           Contains("mount offset is wrong by about"));
}

TEST_CASE("Scattered outliers are no track") {
  BeaconObservation beacon = healthy_beacon();
  beacon.fix_outcomes.reports = 60;
  for (int i = 0; i < 12; ++i) beacon.fix_outcomes.outliers_m.emplace_back(std::cos(i), std::sin(i), 0);
  const auto findings = findings_with([&](auto& b) { b = beacon; });
  CHECK(found(findings, "takes 12 of its 60 fixes for outliers, which are scattered").severity ==
        Severity::warning);
  beacon.fix_outcomes.reports = 6000;
  CHECK_FALSE(has_problems(findings_with([&](auto& b) { b = beacon; })));
}

TEST_CASE("A move of the map is found among many good fixes") {
  BeaconObservation beacon = healthy_beacon();
  beacon.fix_outcomes.reports = 1000;
  beacon.fix_outcomes.relocations = 1;
  beacon.fix_outcomes.longest_relocation_m = 1.56;
  const auto problems = [&] {
    Observations observations = healthy();
    observations.beacons = {beacon};
    return problems_of(observations);
  };
  CHECK_THAT(problems(),
             Contains("its position jumped once, by up to 1.56 m, to fixes that it had rejected"));
  beacon.fix_outcomes.relocations = 2;
  beacon.status_counts.add(status_frozen_track);  // this does not hide the jumps
  CHECK_THAT(problems(), Contains("its position jumped 2 times, by up to 1.56 m"));
}

TEST_CASE("A move of the map is one jump, also where an engine spreads it over several fixes") {
  for (const settings::EngineKind engine : {settings::EngineKind::kalman, settings::EngineKind::documented}) {
    CAPTURE(static_cast<int>(engine));
    auto events = events_of("walk", 1933, 25.5);
    const TimeNs moved_ns = available_at_ns(events.front()) + to_ns(15);
    for (auto* fix : sonopose::test::each<UltrasonicFix>(events)) {
      if (fix->received_time_ns > moved_ns) fix->position_world_m += Vector3d(0.9, -1.2, 0);
    }
    settings::Settings settings;
    settings.engine.engine = engine;
    const auto outcomes = observed(events, settings, {10, 15}).beacons.front().fix_outcomes;
    CHECK(outcomes.relocations == 1);
    CHECK(outcomes.longest_relocation_m == Approx(1.5).margin(0.5));
  }
}

TEST_CASE("A frozen track is found") {
  auto events = events_of("walk", 1932, 18.5);
  std::optional<Vector3d> frozen_at;
  for (auto* fix : sonopose::test::each<UltrasonicFix>(events)) {
    if (seconds_between(available_at_ns(events.front()), fix->received_time_ns) < 11) continue;
    if (!frozen_at) frozen_at = fix->position_world_m;
    fix->position_world_m = *frozen_at;
  }
  const std::string problems = problems_of(observed(events, {}, {10, 8}));
  CHECK_THAT(problems, Contains("repeat one position although the IMU measures motion"));
  CHECK_THAT(problems, !Contains("wrong sign") && !Contains("mount offset"));  // the IMU is right
  CHECK_THAT(problems, !Contains("scattered") && !Contains("min_quality_percent"));
}

}  // namespace tracks_test
