/// The program sonopose-simulate.

#include "recording/log_folder.hpp"
#include "sim/simulator.hpp"
#include "support/checked_run.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <numbers>
#include <string>
#include <vector>

namespace simulate_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

Result simulate(const std::vector<std::string>& arguments) {
  return run(SONOPOSE_TEST_SIMULATE, arguments);
}

/// Runs the program with arguments that it must refuse; returns the message.
std::string refusal(const std::vector<std::string>& arguments) {
  return refusal_of(SONOPOSE_TEST_SIMULATE, arguments);
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

SCENARIO("a simulated run is written as a log with truth") {
  const TemporaryFolder folder;
  GIVEN("twelve seconds of a line with losses, with seed 5") {
    const std::string out = (folder / "log").string();
    const Result result = simulate({"packet_loss", "--out", out, "--seed", "5", "--duration", "12"});
    REQUIRE(result.code == 0);
    THEN("it equals the output of the simulator, including late and duplicated packets") {
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
    THEN("it prints what it wrote") {
      CHECK_THAT(result.output, Contains(out) && Contains("packet_loss") && Contains("seed 5") &&
                                    Contains("12 s") && Contains("IMU samples"));
    }
  }
  GIVEN("an installation of one's own") {
    const std::string out = (folder / "installed").string();
    REQUIRE(simulate({"wrong_delay", "--out", out, "--seed", "5", "--duration", "8", "--mount-offset-deg",
                      "-90", "--delay-error-ms", "25", "--lever-arm-m", "0.1", "-0.05", "0.02"})
                .code == 0);
    THEN("the log is that of these sensors: the stamps of the fixes are 25 ms too young") {
      const sim::Run run{.seed = 5, .duration_s = 8.0};
      sim::Scenario installed = sim::drawn(sim::find_scenario("wrong_delay"), run);
      installed.sensors.pair_mount_offset_rad = -0.5 * std::numbers::pi;
      installed.sensors.reported_delay_error_s = -0.025;
      installed.sensors.imu_from_tracked_point_body_m = {0.1, -0.05, 0.02};
      const auto expected = sim::record(installed, run);
      const recording::SensorLog log = recording::read_sensor_log(out);
      REQUIRE(log.events.size() == expected.events.size());
      for (std::size_t i = 0; i < log.events.size(); ++i) {
        REQUIRE(log.events[i].index() == expected.events[i].index());
        if (const auto* imu = std::get_if<ImuSample>(&log.events[i])) {
          const auto& other = std::get<ImuSample>(expected.events[i]);
          REQUIRE(imu->specific_force_body_mps2 == other.specific_force_body_mps2);
        } else if (const auto* fix = std::get_if<UltrasonicFix>(&log.events[i])) {
          const auto& other = std::get<UltrasonicFix>(expected.events[i]);
          REQUIRE(fix->emission_time_ns == other.emission_time_ns);
        } else {
          const auto& other = std::get<PairHeading>(expected.events[i]);
          REQUIRE(std::get<PairHeading>(log.events[i]).heading_world_rad ==
                  Approx(other.heading_world_rad).margin(1e-9));
        }
      }
    }
    THEN("an impossible one is refused") {
      CHECK_THAT(refusal({"kart", "--out", (folder / "x").string(), "--lever-arm-m", "0.1", "0.2"}),
                 Contains("--lever-arm-m"));
      CHECK_THAT(refusal({"kart", "--out", (folder / "x").string(), "--mount-offset-deg", "200"}),
                 Contains("--mount-offset-deg"));
    }
  }
  GIVEN("the same seed twice, and another seed") {
    REQUIRE(simulate({"kart", "--out", (folder / "a").string(), "--seed", "2"}).code == 0);
    REQUIRE(simulate({"kart", "--out", (folder / "b").string(), "--seed", "2"}).code == 0);
    REQUIRE(simulate({"kart", "--out", (folder / "c").string(), "--seed", "3"}).code == 0);
    THEN("the same seed gives the same bytes, another seed different ones") {
      CHECK(bytes_of(folder / "a") == bytes_of(folder / "b"));
      CHECK(bytes_of(folder / "a") != bytes_of(folder / "c"));
    }
  }
  GIVEN("no duration") {
    REQUIRE(simulate({"outages", "--out", (folder / "log").string()}).code == 0);
    THEN("the duration is that of the scenario") {
      CHECK(recording::read_sensor_log(folder / "log").truth.size() == 7500);
    }
  }
  GIVEN("--list") {
    const Result result = simulate({"--list"});
    REQUIRE(result.code == 0);
    THEN("it prints every scenario with its summary") {
      for (const auto& group : {sim::scenarios(), sim::harder_scenarios()}) {
        for (const sim::Scenario& scenario : group) {
          CHECK_THAT(result.output,
                     Contains(std::string(scenario.name)) && Contains(std::string(scenario.summary)));
        }
      }
    }
  }
}

SCENARIO("only a simulated run that has ended looks complete") {
  const TemporaryFolder folder;
  GIVEN("a run that is complete") {
    REQUIRE(simulate({"walk", "--out", (folder / "log").string(), "--seed", "5", "--duration", "2"}).code ==
            0);
    THEN("the folder has its name, and says what made it") {
      CHECK_FALSE(exists(folder / "log.part"));
      const auto meta = recording::read_log_meta(folder / "log");
      CHECK(meta.program_version == recording::program_version());
      CHECK(meta.settings ==
            recording::LogSettings{{"duration_s", "2"}, {"scenario", "walk"}, {"seed", "5"}});
    }
  }
  GIVEN("a run of ten hours, which is killed") {
    Process process(SONOPOSE_TEST_SIMULATE,
                    {"walk", "--out", (folder / "log").string(), "--duration", "36000"});
    REQUIRE(wait_until([&] { return exists(folder / "log.part/imu.csv"); }));
    process.end_by(SIGKILL);
    THEN("the folder keeps the name of a part") {
      CHECK_FALSE(exists(folder / "log"));
      CHECK(exists(folder / "log.part"));
    }
  }
}

SCENARIO("invalid requests are refused") {
  const TemporaryFolder folder;
  const std::string out = (folder / "log").string();
  WHEN("the scenario does not exist") {
    THEN("the existing scenarios are named, and no folder is created") {
      CHECK_THAT(refusal({"swim", "--out", out}),
                 Contains("swim") && Contains("forklift") && Contains("packet_loss"));
      CHECK_FALSE(exists(folder / "log"));
    }
  }
  WHEN("the scenario, the folder or a value is missing") {
    THEN("the error message says so") {
      CHECK_THAT(refusal({"--out", out}), Contains("SCENARIO"));
      CHECK_THAT(refusal({"walk"}), Contains("--out"));
      CHECK_THAT(refusal({"walk", "--out", out, "--duration", "-1"}),
                 Contains("--duration") && Contains("-1"));
      CHECK_THAT(refusal({"walk", "--out", out, "--seed", "many"}), Contains("--seed") && Contains("many"));
    }
  }
  WHEN("the folder contains a recording") {
    REQUIRE(simulate({"rest", "--out", out, "--duration", "1"}).code == 0);
    const std::string before = bytes_of(out);
    THEN("it is refused, and the recording is unchanged") {
      CHECK_THAT(refusal({"walk", "--out", out}), Contains(out) && Contains("not overwritten"));
      CHECK(bytes_of(out) == before);
    }
  }
}

}  // namespace simulate_test
