#include "evaluation/replay/cases.hpp"

#include "support/events.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace cases_test {

using namespace sonopose;
using namespace sonopose::test;

SCENARIO("every recording at or below a folder is found, and what is left out is named") {
  GIVEN(
      "a log without truth, an attitude recording without fixes, an unfinished recording, and a folder of "
      "something else") {
    const TemporaryFolder folder;
    const auto add = [&folder](const char* log, std::initializer_list<const char*> files) {
      std::filesystem::create_directories(folder / log);
      for (const char* file : files) write_text(folder / log / file, "");
    };
    add("runs/walk", {"imu.csv", "ultrasonic.csv"});
    add("runs/bench", {"imu.csv", "truth.csv"});
    add("notes", {"notes.txt"});
    add("night.part/beacon_7", {"imu.csv", "ultrasonic.csv"});
    THEN("the log alone is found, and the others are named") {
      const evaluation::FoundRecordings found = evaluation::recordings_in(folder.path());
      CHECK(found.folders == std::vector{folder / "runs/walk"});
      REQUIRE(found.left_out.size() == 2);
      CHECK(found.left_out.front() ==
            (folder / "night.part").string() + ": is not complete; name it to score it");
      CHECK(found.left_out.back() == (folder / "runs/bench").string() + ": has no ultrasonic.csv");
      CHECK(evaluation::recordings_in(folder / "runs/walk").folders.size() == 1);
    }
  }
  CHECK_THROWS_WITH(evaluation::recordings_in("/nowhere/at/all"), Catch::Contains("/nowhere/at/all"));
}

SCENARIO("a case of a scenario that varies has the disturbances of its run") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const evaluation::Case hall = evaluation::simulated_case(sim::find_scenario("hall"), seed);
    const evaluation::Case moved = evaluation::simulated_case(sim::find_scenario("moved_map"), seed);
    THEN("no fix of seed " + std::to_string(seed) + " was emitted in one of its outages") {
      REQUIRE_FALSE(hall.outages.empty());
      for (const auto* fix : test::each<UltrasonicFix>(hall.events)) {
        const double time_s = seconds_between(available_at_ns(hall.events.front()), fix->emission_time_ns);
        REQUIRE_FALSE(sim::is_outage(hall.outages, time_s));
      }
    }
    THEN("the map of seed " + std::to_string(seed) + " moves where its truth jumps") {
      REQUIRE(moved.relocations.size() == 1);
      const TimeNs at_ns = moved.truth.front().time_ns + to_ns(moved.relocations.front().at_s);
      for (std::size_t i = 1; i < moved.truth.size(); ++i) {
        const double step_m = (moved.truth[i].position_world_m - moved.truth[i - 1].position_world_m).norm();
        if (step_m < 0.05) continue;
        CHECK(moved.truth[i - 1].time_ns < at_ns);
        CHECK(moved.truth[i].time_ns >= at_ns);
      }
    }
  }
}

}  // namespace cases_test
