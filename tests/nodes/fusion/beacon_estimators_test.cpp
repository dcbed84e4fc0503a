#include "fusion/estimators_feeder.hpp"
#include "support/poses_of.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace beacon_estimators_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::fusion::test;
using settings::EngineKind;

constexpr TimeNs ms = 1'000'000;

/// Poses of a bare engine.
std::vector<FusedPose> poses_with(EngineKind engine, const std::vector<Event>& events) {
  estimation::AnyEstimator estimator{settings_of(engine)};
  return sonopose::test::poses_of(estimator, events);
}

SCENARIO("each beacon has its own estimator") {
  const EngineKind engine = GENERATE(EngineKind::documented, EngineKind::kalman);
  const bool lossless = GENERATE(false, true);
  GIVEN("two beacons whose events come mixed") {
    const auto seven = walk(7, 5.0);
    const auto eight = walk(8, 5.0);
    Feeder feeder(lossless, config_of(engine));
    for (std::size_t i = 0; i < std::max(seven.size(), eight.size()); ++i) {
      if (i < seven.size()) feeder.push(seven[i]);
      if (i < eight.size()) feeder.push(eight[i]);
    }
    THEN("each one's poses are those of a bare engine that hears it alone, to the last bit") {
      CHECK(feeder.poses_of(7).size() == 500);
      CHECK(same(feeder.poses_of(7), poses_with(engine, seven)));
      CHECK(same(feeder.poses_of(8), poses_with(engine, eight)));
      CHECK_FALSE(same(feeder.poses_of(7), feeder.poses_of(8)));
    }
    THEN("each one's status counts its own") {
      auto addresses = feeder.estimators.with([](auto& all) { return all.addresses(); });
      std::sort(addresses.begin(), addresses.end());
      CHECK(addresses == std::vector<BeaconAddress>{7, 8});
      const auto status = feeder.status(8);
      REQUIRE(status);
      CHECK(status->address == 8);
      CHECK(status->imu_samples == 500);
      CHECK(status->fixes_used + status->fixes_rejected + status->headings + 500 == eight.size());
      CHECK(status->events_lost == 0);
      CHECK_FALSE(feeder.status(9));
    }
    THEN("every fix has its report") {
      const auto is_fix = [](const Event& event) { return std::holds_alternative<UltrasonicFix>(event); };
      const auto fixes = std::count_if(seven.begin(), seven.end(), is_fix) +
                         std::count_if(eight.begin(), eight.end(), is_fix);
      CHECK(feeder.reports.size() == static_cast<std::size_t>(fixes));
    }
    WHEN("one is reset") {
      feeder.reset(7);
      THEN("its counter rises and the other's does not") {
        CHECK(feeder.status(7)->reset_counter == 1);
        CHECK(feeder.status(8)->reset_counter == 0);
      }
    }
    WHEN("all are reset") {
      feeder.reset(all_beacons);
      THEN("both counters rise") {
        CHECK(feeder.status(7)->reset_counter == 1);
        CHECK(feeder.status(8)->reset_counter == 1);
      }
    }
  }
  GIVEN("a fix that comes two seconds after its measurement, and an impossible one") {
    Feeder feeder(lossless, config_of(engine));
    const auto events = walk(7, 5.0);
    feeder.push_all(events);
    const auto before = feeder.status(7);
    UltrasonicFix late;
    late.address = 7;
    late.sequence = events.size() + 1;
    late.received_time_ns = available_at_ns(events.back());
    late.emission_time_ns = late.received_time_ns - 2000 * ms;
    late.measured_delay_s = 2.0;
    feeder.push(late);
    UltrasonicFix impossible = late;
    impossible.sequence = late.sequence + 1;
    impossible.position_world_m.x() = 1e9;
    feeder.push(impossible);
    THEN("reports and counters distinguish them") {
      REQUIRE(feeder.reports.size() >= 2);
      CHECK(feeder.reports.rbegin()[1].flags == fix_too_late);
      CHECK(feeder.reports.back().flags == fix_invalid);
      CHECK(before->fixes_late == 0);
      CHECK(feeder.status(7)->fixes_late == 1);
      CHECK(feeder.status(7)->fixes_rejected == before->fixes_rejected + 2);
    }
  }
  GIVEN("a setting that differs for one beacon: its pair stands across") {
    config::FusionConfig config = config_of(engine);
    config.assign("beacon.8.heading.mount_offset_deg=90");
    Feeder feeder(lossless, config);
    feeder.push_all(walk(7, 5.0));
    feeder.push_all(walk(8, 5.0));
    THEN("that one alone is turned by it") {
      CHECK(same(feeder.poses_of(7), poses_with(engine, walk(7, 5.0))));
      CHECK_FALSE(same(feeder.poses_of(8), poses_with(engine, walk(8, 5.0))));
    }
  }
}

SCENARIO("the documented engine beside the Kalman engine") {
  const bool lossless = GENERATE(false, true);
  GIVEN("another engine for one beacon") {
    config::FusionConfig config = documented_config();
    config.assign("beacon.8.fusion.engine=kalman");
    Feeder feeder(lossless, config);
    feeder.push_all(walk(7, 5.0));
    feeder.push_all(walk(8, 5.0));
    THEN("that one alone has its poses, and estimates what only that engine does") {
      CHECK(same(feeder.poses_of(7), poses_with(EngineKind::documented, walk(7, 5.0))));
      CHECK(same(feeder.poses_of(8), poses_with(EngineKind::kalman, walk(8, 5.0))));
      CHECK_FALSE(feeder.estimate(7).lever_arm_body_m);
      CHECK(feeder.estimate(8).lever_arm_body_m);
    }
  }
  GIVEN("a fix of the documented engine that is off by half a metre") {
    Feeder feeder(lossless, documented_config());
    auto events = walk(7, 5.0);
    const auto last_fix = std::find_if(events.rbegin(), events.rend(), [](const Event& event) {
      return std::holds_alternative<UltrasonicFix>(event);
    });
    std::get<UltrasonicFix>(*last_fix).position_world_m.x() += 0.5;
    feeder.push_all(events);
    THEN("it is used with less weight, and counted") {
      REQUIRE((feeder.reports.back().flags & fix_outlier) != 0);
      const auto down_weighted = static_cast<std::uint64_t>(
          std::count_if(feeder.reports.begin(), feeder.reports.end(), is_down_weighted));
      CHECK(down_weighted >= 1);
      CHECK(feeder.status(7)->fixes_down_weighted == down_weighted);
    }
  }
}

SCENARIO("events that arrive out of order are put in order") {
  const EngineKind engine = GENERATE(EngineKind::documented, EngineKind::kalman);
  const auto events = walk(7, 5.0);
  GIVEN("neighbours that are swapped here and there, as three topics do") {
    Feeder feeder(false, config_of(engine));
    auto mixed = events;
    for (std::size_t i = 10; i + 1 < mixed.size(); i += 7) std::swap(mixed[i], mixed[i + 1]);
    SteadyTime arrival{begin_ns};
    for (const Event& event : mixed) feeder.push(event, arrival += ms / 10);
    THEN("the poses are those of the right order") {
      CHECK(same(feeder.poses_of(7), poses_with(engine, events)));
      CHECK(feeder.status(7)->events_lost == 0);
    }
  }
  GIVEN("an event that never comes") {
    Feeder feeder(false, config_of(engine));
    auto missing = events;
    const auto lost = std::find_if(missing.begin() + 200, missing.end(), [](const Event& event) {
      return std::holds_alternative<PairHeading>(event);
    });
    missing.erase(lost);
    feeder.push_all(missing);
    THEN("live, it is counted as lost after the timeout; every IMU sample has its pose") {
      CHECK(feeder.poses.size() == 500);
      CHECK(feeder.status(7)->events_lost == 1);
    }
  }
  GIVEN("the same where nothing may be lost") {
    Feeder feeder(true, config_of(engine));
    auto late = events;
    const Event straggler = late[200];
    late.erase(late.begin() + 200);
    feeder.push_all(late);
    const std::size_t before = feeder.poses.size();
    THEN("all wait for it without a time limit and are then released together") {
      CHECK(before < 250);
      feeder.push(straggler);
      CHECK(same(feeder.poses, poses_with(engine, events)));
      CHECK(feeder.status(7)->events_lost == 0);
    }
  }
}

SCENARIO("a repeated reset does nothing") {
  Feeder feeder(false, config_of(GENERATE(EngineKind::documented, EngineKind::kalman)));
  feeder.push_all(walk(7, 1.0));
  feeder.reset(7, 41);
  feeder.reset(7, 41);
  CHECK(feeder.status(7)->reset_counter == 1);
  feeder.reset(7, 42);
  CHECK(feeder.status(7)->reset_counter == 2);
  WHEN("the requests have no id") {
    feeder.reset(7);
    feeder.reset(7);
    THEN("each one counts") {
      CHECK(feeder.status(7)->reset_counter == 4);
    }
  }
}

SCENARIO("published counters do not decrease when an IMU sample refutes the stamp of a heading") {
  Feeder feeder(false, config_of(EngineKind::kalman));
  std::uint64_t headings = 0;
  for (Event event : walk(7, 6.0)) {
    if (auto* const heading = std::get_if<PairHeading>(&event);
        heading && heading->emission_time_ns > begin_ns + 4000 * ms) {
      heading->emission_time_ns += 700 * ms;
      heading->received_time_ns += 700 * ms;
    }
    feeder.push(event);
    const auto status = feeder.status(7);
    REQUIRE(status);
    CHECK(status->headings >= headings);
    headings = status->headings;
  }
  CHECK(headings > 10);
  CHECK(feeder.status(7)->samples_invalid > 0);
}

SCENARIO("missed deadlines and the loss of a bridge are counted") {
  BeaconEstimator seven(7, SettingsTimeline(config::BeaconSettings{}), false);
  seven.on_deadline_missed(&FusionStatus::imu_deadlines_missed, 2);
  seven.on_deadline_missed(&FusionStatus::fix_deadlines_missed, 1);
  CHECK(seven.status().imu_deadlines_missed == 2);
  CHECK(seven.status().fix_deadlines_missed == 1);
  CHECK(seven.status().heading_deadlines_missed == 0);
  seven.collate(ImuSample{}, 100, SteadyTime{begin_ns}, SteadyTime{begin_ns});
  const auto losses_after = [&seven](TimeNs later_ns) {
    seven.find_silence_change(SteadyTime{begin_ns + later_ns}, 3600'000 * ms);
    return seven.status().bridge_losses;
  };
  seven.on_bridge_lost(200, SteadyTime{begin_ns});  // this bridge sends other beacons
  CHECK(losses_after(500 * ms) == 0);
  seven.on_bridge_lost(100, SteadyTime{begin_ns + 500 * ms});
  CHECK(losses_after(600 * ms) == 0);  // it may end in good order
  WHEN("nothing more is heard") {
    CHECK(losses_after(900 * ms) == 1);
    CHECK(losses_after(5000 * ms) == 1);
    seven.on_bridge_ended(100);  // the end of its lease
    AND_WHEN("the beacon has moved to another bridge") {
      seven.collate(ImuSample{}, 200, SteadyTime{begin_ns}, SteadyTime{begin_ns});
      seven.on_bridge_lost(100, SteadyTime{begin_ns});
      CHECK(losses_after(9000 * ms) == 1);
    }
  }
  WHEN("it ends in good order") {
    seven.on_bridge_ended(200);
    seven.on_bridge_ended(100);
    CHECK(losses_after(900 * ms) == 0);
  }
}

SCENARIO("a change of one beacon waits for its report") {
  constexpr TimeNs deadline_ns = 100 * ms;
  const SteadyTime start{begin_ns};
  GIVEN("two beacons whose first changes were reported") {
    BeaconEstimators estimators(config_of(EngineKind::kalman), false);
    const auto send = [&](BeaconAddress address, SteadyTime at) {
      estimators.find_or_make(address)->collate(ImuSample{}, 100, at, at);
    };
    send(7, start);
    send(8, start);
    CHECK(estimators.have_unreported_changes(start, deadline_ns));  // both beacons are new
    estimators.for_each([](BeaconAddress, BeaconEstimator& each) { each.transitions().clear(); });
    CHECK_FALSE(estimators.have_unreported_changes(start, deadline_ns));
    WHEN("one falls silent and the other one does not") {
      const SteadyTime later = start + deadline_ns + ms;
      send(8, later);
      THEN("its silence waits until it is found, and then its line") {
        CHECK(estimators.have_unreported_changes(later, deadline_ns));
        CHECK_FALSE(estimators.find(8)->find_silence_change(later, deadline_ns));
        CHECK(estimators.find(7)->find_silence_change(later, deadline_ns));
        CHECK(estimators.have_unreported_changes(later, deadline_ns));
        estimators.find(7)->transitions().clear();
        CHECK_FALSE(estimators.have_unreported_changes(later, deadline_ns));
      }
    }
  }
}

SCENARIO("a bridge that restarts") {
  const EngineKind engine = GENERATE(EngineKind::documented, EngineKind::kalman);
  const bool lossless = GENERATE(false, true);
  GIVEN("an engine that has followed a beacon") {
    Feeder feeder(lossless, config_of(engine));
    feeder.push_all(walk(7, 5.0));
    WHEN("the same recording is played again: its times are older") {
      feeder.poses.clear();
      SteadyTime arrival{begin_ns + 10'000 * ms};
      for (const Event& event : walk(7, 5.0)) feeder.push(event, arrival += ms);
      THEN("the estimator is reset too") {
        CHECK(feeder.status(7)->reset_counter == 1);
        REQUIRE(feeder.poses.size() >= 495);  // live, the first events pass before the restart is certain
        CHECK(feeder.poses.back().reset_counter == 1);
        CHECK(
            (feeder.poses.back().position_world_m - poses_with(engine, walk(7, 5.0)).back().position_world_m)
                .norm() < 0.05);
      }
    }
    WHEN("the bridge was started again: its numbers are older, its times are not") {
      feeder.poses.clear();
      feeder.push_all(walk(7, 5.0, begin_ns + 5'000 * ms));
      THEN("the engine goes on with what it knows") {
        CHECK(feeder.status(7)->reset_counter == 0);
        CHECK(feeder.poses.size() >= 495);
        CHECK((feeder.poses.front().status & status_initialising) == 0U);
      }
    }
  }
}

}  // namespace beacon_estimators_test
