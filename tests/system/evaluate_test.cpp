/// The programs sonopose-evaluate and sonopose-tune: effective settings, seeds and errors.

#include "support/checked_run.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace evaluate_test {

using namespace sonopose::test;
using Catch::Contains;
using nlohmann::json;

/// Fused error of one run of one scenario.
double rmse_of(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(),
                   {"walk", "--seeds", "1", "--json", "--set", "fusion.engine=documented"});
  return json::parse(output_of(SONOPOSE_TEST_EVALUATE, arguments)).at(0).at("position_rmse_m").get<double>();
}

/// Runs the program with a full output device.
Result into_full_disk(const std::string& program, const std::string& arguments) {
  return run("/bin/sh", {"-c", "\"$0\" " + arguments + " > /dev/full", program});
}

SCENARIO("--beacon selects the settings that are scored") {
  const double plain = rmse_of({});
  const double worse = rmse_of(
      {"--set", "documented.trust.sigma_m=5", "--set", "documented.attitude.adaptive.accel_time_s=1"});
  REQUIRE(worse != plain);
  const std::vector<std::string> of_nine{"--set", "beacon.9.documented.trust.sigma_m=5", "--set",
                                         "beacon.9.documented.attitude.adaptive.accel_time_s=1"};
  CHECK(rmse_of(of_nine) == plain);
  auto named = of_nine;
  named.insert(named.end(), {"--beacon", "9"});
  CHECK(rmse_of(named) == worse);
  CHECK(rmse_of({"--set", "beacon.7.documented.trust.sigma_m=5", "--set",
                 "beacon.7.documented.attitude.adaptive.accel_time_s=1"}) == worse);
}

SCENARIO("the row of a case is printed before the next case ends") {
  Process evaluate(SONOPOSE_TEST_EVALUATE,
                   {"walk", "kart", "forklift", "drone", "spin", "circle", "--seeds", "8"});
  REQUIRE(evaluate.wait_for_line(Process::Stream::output, "walk"));
  CHECK_THAT(evaluate.text(Process::Stream::output), !Contains("circle"));
  CHECK_FALSE(evaluate.wait_for_exit(std::chrono::milliseconds(0)));
}

SCENARIO("--engine scores each engine in a row of its own") {
  const json rows = json::parse(output_of(
      SONOPOSE_TEST_EVALUATE, {"no_heading", "--seeds", "1", "--json", "--engine", "documented", "kalman"}));
  REQUIRE(rows.size() == 2);
  CHECK(rows.at(0).at("engine") == "documented");
  CHECK(rows.at(1).at("engine") == "kalman");
  // Only the Kalman engine finds the yaw without a pair.
  CHECK(rows.at(1).at("yaw_rmse_deg").get<double>() < 0.5 * rows.at(0).at("yaw_rmse_deg").get<double>());
  CHECK(run(SONOPOSE_TEST_EVALUATE, {"walk", "--engine", "strapdown"}).code != 0);
}

SCENARIO("--engine warns of another beacon's settings once, and not of the other engine's") {
  const Result result = run(SONOPOSE_TEST_EVALUATE,
                            {"rest", "--seeds", "1", "--set", "documented.trust.sigma_m=0.7", "--set",
                             "beacon.9.documented.trust.sigma_m=5", "--engine", "documented", "kalman"});
  REQUIRE(result.code == 0);
  const std::size_t named = result.error.find("not used: the settings of beacon 9");
  REQUIRE(named != std::string::npos);
  CHECK(result.error.find("not used: the settings of beacon 9", named + 1) == std::string::npos);
  CHECK_THAT(result.error, !Contains("has no effect"));
}

SCENARIO("another first seed gives other runs") {
  const double first = rmse_of({});
  CHECK(rmse_of({"--first-seed", "1"}) == first);
  CHECK(rmse_of({"--first-seed", "101"}) != first);
}

SCENARIO("--harder scores the harder scenarios, the violations, and those that are named") {
  const json rows =
      json::parse(output_of(SONOPOSE_TEST_EVALUATE, {"rest", "--harder", "--seeds", "1", "--json"}));
  REQUIRE(rows.size() == 35);
  CHECK(rows.at(0).at("case") == "rest");
  CHECK(rows.at(1).at("case") == "wrong_tracks");
  for (const json& row : rows) CHECK(row.at("position_rmse_m").is_number());
}

SCENARIO("a search prints settings that are effective for the selected beacon") {
  const Result result =
      run(SONOPOSE_TEST_TUNE,
          {"walk", "--seeds", "1", "--rounds", "1", "--beacon", "9", "--set", "fusion.engine=documented",
           "--set", "beacon.9.documented.trust.sigma_m=0.3", "--vary", "documented.trust.sigma_m=0.1..0.2"});
  CAPTURE(result.error);
  REQUIRE(result.code == 0);
  const TemporaryFolder folder;
  write_text(folder / "found.toml", result.output);
  const std::string config = (folder / "found.toml").string();
  CHECK(rmse_of({"--config", config, "--beacon", "9"}) !=
        rmse_of({"--config", config, "--beacon", "9", "--set", "beacon.9.documented.trust.sigma_m=0.3"}));
}

SCENARIO("a search of a setting that another one replaces is refused") {
  const Result result = run(SONOPOSE_TEST_TUNE, {"walk", "--set", "fusion.engine=documented", "--vary",
                                                 "documented.drift.jump_alpha"});
  CHECK(result.code != 0);
  CHECK_THAT(result.error,
             Contains("--vary documented.drift.jump_alpha: documented.imu_weight = medium sets it; add --set "
                      "documented.imu_weight=user"));
}

SCENARIO("own logs are scored with and without truth, alone, and what is left out is named") {
  GIVEN("a log named like a scenario, the same without truth, one without fixes and a damaged one") {
    const TemporaryFolder folder;
    const auto log = folder / "walk";
    REQUIRE(run(SONOPOSE_TEST_SIMULATE, {"walk", "--duration", "20", "--out", log.string()}).code == 0);
    std::filesystem::copy(log, folder / "blind");
    std::filesystem::remove(folder / "blind" / "truth.csv");
    std::filesystem::copy(log, folder / "bench");
    std::filesystem::remove(folder / "bench" / "ultrasonic.csv");
    std::filesystem::copy(log, folder / "torn");
    write_text(folder / "torn" / "ultrasonic.csv", "#\n1,2\n");
    WHEN("the folder is scored") {
      const Result result = run(SONOPOSE_TEST_EVALUATE, {folder.path().string(), "--json"});
      CAPTURE(result.error);
      REQUIRE(result.code == 0);
      THEN("each log has a row of its path, no scenario has one, and the logs that are left out are named") {
        const json rows = json::parse(result.output);
        REQUIRE(rows.size() == 2);
        CHECK(rows.at(0).at("case") == (folder / "blind").string());
        CHECK(rows.at(0).at("position_rmse_m").is_null());
        CHECK(rows.at(0).at("prediction").at(0).at("distance_rms_m").get<double>() < 0.06);
        CHECK(rows.at(1).at("case") == log.string());
        CHECK(rows.at(1).at("position_rmse_m").get<double>() < 0.03);
        CHECK_THAT(result.error,
                   Contains("left out: " + (folder / "bench").string() + ": has no ultrasonic.csv"));
        CHECK_THAT(result.error,
                   Contains("left out: " + (folder / "torn" / "ultrasonic.csv").string() + ":1"));
      }
    }
    WHEN("two of them are named, of which one is damaged") {
      const Result result = run(SONOPOSE_TEST_EVALUATE, {log.string(), (folder / "torn").string(), "--json"});
      THEN("the other one is scored, and the exit code is 1") {
        CHECK(result.code == 1);
        CHECK(json::parse(result.output).size() == 1);
        CHECK_THAT(result.error, Contains("left out: " + (folder / "torn" / "ultrasonic.csv").string()));
      }
    }
    WHEN("two files of settings are compared") {
      write_text(folder / "right.toml", "[heading]\nmount_offset_deg = 0\n");
      write_text(folder / "wrong.toml", "[heading]\nmount_offset_deg = 40\n");
      const json comparison = json::parse(output_of(
          SONOPOSE_TEST_EVALUATE, {folder.path().string(), "--json", "--compare",
                                   (folder / "right.toml").string(), (folder / "wrong.toml").string()}));
      THEN("the wrong mount is worse on each, with and without truth") {
        REQUIRE(comparison.at("cases").size() == 2);
        for (const json& row : comparison.at("cases")) {
          CHECK(row.at("change").get<double>() > 0.01);  // the motion overrules the headings
        }
      }
    }
  }
  GIVEN("an unknown name") {
    const Result none = run(SONOPOSE_TEST_EVALUATE, {"no_such_case"});
    THEN("it is named") {
      CHECK(none.code == 1);
      CHECK_THAT(none.error, Contains("no_such_case"));
    }
  }
}

SCENARIO("what a search writes to the journal has priorities") {
  const TemporaryFolder folder;
  const auto log = folder / "drive";
  REQUIRE(run(SONOPOSE_TEST_SIMULATE, {"forklift", "--duration", "30", "--out", log.string()}).code == 0);
  std::filesystem::copy(log, folder / "bench");
  std::filesystem::remove(folder / "bench" / "ultrasonic.csv");
  Process search("/bin/sh", {"-c", R"(JOURNAL_STREAM=$(stat -L -c %d:%i /proc/self/fd/2) exec "$0" "$@")",
                             SONOPOSE_TEST_TUNE, "--recordings", folder.path().string(), log.string(),
                             "--rounds", "1000000", "--set", "heading.mount_offset_deg=60", "--vary",
                             "heading.mount_offset_deg=-90..90"});
  REQUIRE(search.wait_for_line(Process::Stream::error, "<6>round"));
  CHECK(search.end_by(SIGINT).code == 0);
  const auto lines = search.lines(Process::Stream::error);
  CHECK(lines.size() >= 3);
  for (const std::string& line : lines) {
    CAPTURE(line);
    CHECK_THAT(line,
               Catch::Matches("(<6>round |<4>left out: |<4>.*: its mount offset |<6>interrupted after ).*"));
  }
}

SCENARIO(
    "a search on a log without truth takes its prediction errors, and ends at Ctrl-C with the best so far") {
  const TemporaryFolder folder;
  const auto log = folder / "drive";
  REQUIRE(run(SONOPOSE_TEST_SIMULATE, {"forklift", "--duration", "30", "--out", log.string()}).code == 0);
  std::filesystem::remove(log / "truth.csv");
  Process search(SONOPOSE_TEST_TUNE,
                 {log.string(), "--rounds", "1000000", "--set", "heading.mount_offset_deg=60", "--vary",
                  "heading.mount_offset_deg=-90..90"});
  REQUIRE(search.wait_for_line(Process::Stream::error, "round"));
  CHECK(search.end_by(SIGINT).code == 0);
  CHECK_THAT(search.text(Process::Stream::error), Contains("interrupted after"));
  CHECK_THAT(search.text(Process::Stream::output),
             Contains("[heading]") && Contains("mount_offset_deg = ") && !Contains("trust"));
}

SCENARIO("an output that cannot be written is an error") {
  const TemporaryFolder folder;
  const std::string log = (folder / "log").string();
  REQUIRE(run(SONOPOSE_TEST_SIMULATE, {"walk", "--duration", "2", "--out", log}).code == 0);
  for (const Result& result : {into_full_disk(SONOPOSE_TEST_REPLAY, "'" + log + "' --json"),
                               into_full_disk(SONOPOSE_TEST_EVALUATE, "walk --seeds 1")}) {
    CHECK(result.code == 1);
    CHECK_THAT(result.error, Contains("the output cannot be written: No space left on device"));
  }
}

}  // namespace evaluate_test
