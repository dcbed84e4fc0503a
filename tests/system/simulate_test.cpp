/// sonopose-simulate: runs of the simulator as log folders.

#include "support/temporary_folder.hpp"
#include "support/process.hpp"
#include "recording/log_folder.hpp"
#include "sim/simulator.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

namespace {

Result simulate(const std::vector<std::string>& arguments) {
  return run(SONOPOSE_TEST_SIMULATE, arguments);
}

/// Runs it where it must refuse to work; gives what it said.
std::string refusal(const std::vector<std::string>& arguments) {
  const Result result = simulate(arguments);
  CAPTURE(arguments, result.error);
  REQUIRE(result.code);  // it ended by itself
  CHECK(*result.code > 0);
  return result.error;
}

/// The whole recording as text.
std::string bytes_of(const std::filesystem::path& folder) {
  std::string bytes;
  for (const char* name : {"imu.csv", "ultrasonic.csv", "heading.csv", "truth.csv"}) {
    REQUIRE(exists(folder / name));
    bytes += read_text(folder / name);
  }
  return bytes;
}

}  // namespace

SCENARIO("a simulated run is written as a log with its truth") {
  const TemporaryFolder folder;
  GIVEN("twelve seconds of a bad line with seed 5") {
    const std::string out = (folder / "log").string();
    const Result result = simulate({"packet_loss", "--out", out, "--seed", "5", "--duration", "12"});
    REQUIRE(result.code == 0);
    THEN("it reads back as what the simulator gives, late and doubled packets in their places") {
      const auto expected = sim::record(sim::find_scenario("packet_loss"), {.seed = 5, .duration_s = 12.0});
      const recording::SensorLog log = recording::read_sensor_log(out);
      REQUIRE(log.events.size() == expected.events.size());
      for (std::size_t i = 0; i < log.events.size(); ++i) {
        REQUIRE(log.events[i].index() == expected.events[i].index());
        REQUIRE(available_at_ns(log.events[i]) == available_at_ns(expected.events[i]));
      }
      REQUIRE(log.truth.size() == expected.truth.size());
      CHECK(log.truth.back().position_world_m == expected.truth.back().position_world_m);
    }
    THEN("it says what it wrote") {
      CHECK_THAT(result.output, Contains(out) && Contains("packet_loss") && Contains("seed 5") &&
                                    Contains("12 s") && Contains("IMU samples"));
    }
  }
  GIVEN("the same seed twice, and another one") {
    REQUIRE(simulate({"kart", "--out", (folder / "a").string(), "--seed", "2"}).code == 0);
    REQUIRE(simulate({"kart", "--out", (folder / "b").string(), "--seed", "2"}).code == 0);
    REQUIRE(simulate({"kart", "--out", (folder / "c").string(), "--seed", "3"}).code == 0);
    THEN("the same seed gives the same bytes, another one others") {
      CHECK(bytes_of(folder / "a") == bytes_of(folder / "b"));
      CHECK(bytes_of(folder / "a") != bytes_of(folder / "c"));
    }
  }
  GIVEN("no duration") {
    REQUIRE(simulate({"outages", "--out", (folder / "log").string()}).code == 0);
    THEN("it is the scenario's own") {
      CHECK(recording::read_sensor_log(folder / "log").truth.size() == 7500);
    }
  }
  GIVEN("--list") {
    const Result result = simulate({"--list"});
    CHECK(result.code == 0);
    for (const sim::Scenario& scenario : sim::scenarios()) {
      CHECK_THAT(result.output,
                 Contains(std::string(scenario.name)) && Contains(std::string(scenario.summary)));
    }
  }
}

SCENARIO("a simulation that cannot be is refused") {
  const TemporaryFolder folder;
  const std::string out = (folder / "log").string();
  WHEN("the scenario does not exist") {
    THEN("those that do are named, and no folder is made") {
      CHECK_THAT(refusal({"swim", "--out", out}),
                 Contains("swim") && Contains("forklift") && Contains("packet_loss"));
      CHECK_FALSE(exists(folder / "log"));
    }
  }
  WHEN("the scenario, the folder or a value is missing") {
    THEN("that is said") {
      CHECK_THAT(refusal({"--out", out}), Contains("SCENARIO"));
      CHECK_THAT(refusal({"walk"}), Contains("--out"));
      CHECK_THAT(refusal({"walk", "--out", out, "--duration", "-1"}),
                 Contains("--duration") && Contains("-1"));
      CHECK_THAT(refusal({"walk", "--out", out, "--seed", "many"}), Contains("--seed") && Contains("many"));
    }
  }
  WHEN("the folder holds a recording") {
    REQUIRE(simulate({"rest", "--out", out, "--duration", "1"}).code == 0);
    const std::string before = bytes_of(out);
    THEN("it is refused, and the recording is as it was") {
      CHECK_THAT(refusal({"walk", "--out", out}), Contains(out) && Contains("not overwritten"));
      CHECK(bytes_of(out) == before);
    }
  }
}
