/// The program sonopose-import.

#include "sim/simulator.hpp"
#include "support/checked_run.hpp"
#include "support/matches.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <string>
#include <variant>
#include <vector>

namespace import_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

/// Tables of a simulated forklift: times in seconds from the start, those of the positions too late.
void write_tables(const TemporaryFolder& folder, double late_s, double duration_s) {
  const auto run = sim::record(sim::find_scenario("forklift"), {.seed = 41, .duration_s = duration_s});
  const TimeNs start_ns = available_at_ns(run.events.front());
  std::string imu = "time,GyroA_x,GyroA_y,GyroA_z,acc_x,acc_y,acc_z\n";
  std::string positions = "time;x;y;z\n";
  for (const Event& event : run.events) {
    if (const auto* sample = std::get_if<ImuSample>(&event)) {
      const Vector3d& w = sample->angular_velocity_body_radps;
      const Vector3d& a = sample->specific_force_body_mps2;
      imu += fmt::format("{:.6f},{},{},{},{},{},{}\n", seconds_between(start_ns, sample->sensor_time_ns),
                         w.x(), w.y(), w.z(), a.x(), a.y(), a.z());
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      const Vector3d& p = fix->position_world_m;
      positions += fmt::format("{:.6f};{};{};{}\n", seconds_between(start_ns, fix->emission_time_ns) + late_s,
                               p.x(), p.y(), p.z());
    }
  }
  write_text(folder / "imu.csv", imu);
  write_text(folder / "positions.csv", positions);
}

SCENARIO("tables are imported, and the offset of their clocks is found") {
  const TemporaryFolder folder;
  write_tables(folder, 0.08, 90.0);
  std::vector<std::string> arguments{"--imu",       (folder / "imu.csv").string(),
                                     "--positions", (folder / "positions.csv").string(),
                                     "--out",       (folder / "log").string()};
  GIVEN("names that are not known") {
    const Result result = run(SONOPOSE_TEST_IMPORT, arguments);
    THEN("the import is refused with the option to add, and writes nothing") {
      CHECK(result.code == 1);
      CHECK_THAT(result.error, Contains("no column \"w_x") && Contains("--column \"w_x=GyroA_x\""));
      CHECK_FALSE(exists(folder / "log"));
    }
  }
  GIVEN("the names of the gyroscope's columns") {
    for (const char* const name : {"w_x=GyroA_x", "w_y=GyroA_y", "w_z=GyroA_z"}) {
      arguments.insert(arguments.end(), {"--column", name});
    }
    const Result result = run(SONOPOSE_TEST_IMPORT, arguments);
    CAPTURE(result.output, result.error);
    REQUIRE(result.code == 0);
    THEN("it says what it has read, and the offset of the clocks") {
      CHECK_THAT(result.output, Contains("100 Hz") && Contains("on average along +z"));
      const auto match = first_match(result.output, "are ([0-9.]+) s older than their times");
      REQUIRE_FALSE(match.empty());
      CHECK(std::stod(match[1]) == Approx(0.08).margin(0.01));
    }
    THEN("the replay of the log with this setting follows the positions") {
      const Result replay =
          run(SONOPOSE_TEST_REPLAY, {(folder / "log").string(), "--set", "delay.correction_s=0.08"});
      CHECK(replay.code == 0);
      const auto match = first_match(replay.output, "fixes +([0-9]+) used");
      REQUIRE_FALSE(match.empty());
      CHECK(std::stoi(match[1]) > 600);
    }
    THEN("an existing log is not overwritten") {
      const Result again = run(SONOPOSE_TEST_IMPORT, arguments);
      CHECK(again.code == 1);
      CHECK_THAT(again.error, Contains("already contains a recording"));
    }
  }
}

SCENARIO("clocks that differ by more than the fusion corrects are corrected by a second import") {
  const TemporaryFolder folder;
  write_tables(folder, 1.7, 45.0);
  const auto imported = [&folder](const std::string& name, const std::string& shift_s) {
    std::vector<std::string> arguments{
        "--imu", (folder / "imu.csv").string(),   "--positions", (folder / "positions.csv").string(),
        "--out", (folder.path() / name).string(), "--shift",     shift_s};
    for (const char* const column : {"w_x=GyroA_x", "w_y=GyroA_y", "w_z=GyroA_z"})
      arguments.insert(arguments.end(), {"--column", column});
    return output_of(SONOPOSE_TEST_IMPORT, arguments);
  };
  const std::string first = imported("first", "0");
  const auto match = first_match(first, "import again with --shift (-?[0-9.]+)");
  REQUIRE_FALSE(match.empty());
  CHECK(std::stod(match[1]) == Approx(-1.7).margin(0.01));
  CHECK_THAT(imported("second", match[1]), !Contains("import again"));
}

}  // namespace import_test
