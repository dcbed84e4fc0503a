/// The program sonopose-calibrate: its output and its errors.

#include "calibration/simulated_sensor.hpp"
#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace calibrate_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

Result calibrate(const std::vector<std::string>& arguments) {
  return run(SONOPOSE_TEST_CALIBRATE, arguments);
}

std::string write_log(const std::filesystem::path& folder, const std::vector<Vector3d>& up_body) {
  SensorErrors errors;
  errors.accel_offset_mps2 = {0.2, -0.1, 0.3};
  recording::SensorLogWriter writer(folder);
  for (const ImuSample& sample : SimulatedSensor(errors, 1).hold_in_turn(up_body)) writer.write(sample);
  writer.flush();
  return folder.string();
}

SCENARIO("the tables go to standard output, or to a file with the report on standard output") {
  const TemporaryFolder folder;
  const std::string log = write_log(folder / "log", sides_and_corners_of_a_cube());
  const auto out = folder / "calibration.toml";
  const Result shown = calibrate({"imu", log});
  CHECK(shown.code == 0);
  CHECK(shown.error.empty());
  CHECK_THAT(shown.output, Contains("\n[calibration.accelerometer]\n") && Contains("# accelerometer"));
  const Result written = calibrate({"imu", log, "--out", out.string()});
  CHECK(written.code == 0);
  CHECK_THAT(written.output, !Contains("[calibration") && Contains("14 orientations"));
  CHECK(read_text(out) == shown.output);
  const Result own = calibrate({"imu", log, "--out", out.string(), "--beacon", "7", "--json"});
  CHECK(own.code == 0);
  CHECK(nlohmann::json::parse(own.output).contains("accelerometer"));
  CHECK_THAT(read_text(out), Contains("\n[beacon.7.calibration.accelerometer]\n"));
}

SCENARIO("other programs accept the written configuration, and name settings of another beacon") {
  const TemporaryFolder folder;
  const std::string log = write_log(folder / "log", sides_and_corners_of_a_cube());
  const std::string out = (folder / "calibration.toml").string();
  for (const char* const beacon : {"7", "9"}) {
    REQUIRE(calibrate({"imu", log, "--out", out, "--beacon", beacon}).code == 0);
    const Result taken = run(SONOPOSE_TEST_ATTITUDE, {log, "--config", out, "--beacon", "7", "--out",
                                                      (folder / "orientations").string()});
    CHECK(taken.code == 0);
    CHECK(taken.error.empty() == (std::string(beacon) == "7"));
    if (!taken.error.empty()) CHECK_THAT(taken.error, Contains("not used: the settings of beacon 9"));
  }
}

SCENARIO("a failure states the reason and keeps an existing file") {
  const TemporaryFolder folder;
  const std::string log = write_log(folder / "log", {{0, 0, 1}, {1, 0, 0}});
  const auto out = folder / "calibration.toml";
  write_text(out, "precious = 1\n");
  const Result result = calibrate({"imu", log, "--out", out.string()});
  CHECK(result.code == 1);
  CHECK(result.output.empty());
  CHECK_THAT(result.error, Contains("sonopose-calibrate: ") && Contains("imu.csv") && Contains("2 found"));
  CHECK(read_text(out) == "precious = 1\n");
  CHECK(calibrate({"gyroscope", log, "--out", (folder / "none/a.toml").string()}).code == 1);
  CHECK(calibrate({"magnetometer", log}).code == 1);
  CHECK(calibrate({"allan", log}).code == 1);
}

std::string write_drive(const std::filesystem::path& folder, const char* scenario, double duration_s) {
  sim::Scenario installed = sim::find_scenario(scenario);
  installed.sensors.pair_mount_offset_rad = 1.2;
  installed.sensors.reported_delay_error_s = -0.02;
  recording::SensorLogWriter writer(folder);
  for (const Event& event : sim::record(installed, {.seed = 921, .duration_s = duration_s}).events)
    writer.write(event);
  writer.flush();
  return folder.string();
}

SCENARIO("a drive calibrates the installation, as a file of settings, as JSON and as a picture") {
  const TemporaryFolder folder;
  const std::string log = write_drive(folder / "drive", "kart", 60.0);
  const auto settings = folder / "fusion.toml";
  GIVEN("a file with a wrong mount and other settings") {
    write_text(settings,
               "[heading]  # mine\nmount_offset_deg = 10.0\n\n[outage]\nstale_after_s = 2.0\n\n"
               "[beacon.9.heading]\nmount_offset_deg = 20.0\n");
    WHEN("the calibration is written to it") {
      const auto picture = folder / "likelihood.svg";
      const Result result =
          calibrate({"all", log, "--write", settings.string(), "--json", "--plot", picture.string()});
      THEN("mount and delay are right, and the rest is as it was") {
        CHECK(result.code == 0);
        const auto json = nlohmann::json::parse(result.output);
        CHECK(json["mount_method"] == "likelihood");
        CHECK(json["quantities"]["mount"]["value"].get<double>() == Approx(1.2).margin(0.01));
        CHECK(json["quantities"]["delay"]["value"].get<double>() == Approx(0.02).margin(0.004));
        CHECK(json["quantities"]["lever_arm_z"]["value"].is_null());
        CHECK_THAT(json["quantities"]["lever_arm_z"]["missing"].get<std::string>(), Contains("tilt"));
        const std::string text = read_text(settings);
        CHECK_THAT(text, Contains("[heading]  # mine\nmount_offset_deg = 68.") &&
                             Contains("stale_after_s = 2.0") && Contains("[delay]\ncorrection_s = 0.0"));
        CHECK_THAT(read_text(picture), Contains("<svg") && Contains("mount [deg]"));
      }
      AND_THEN("no progress is shown without a terminal, but a warning of the mount of beacon 9") {
        CHECK_THAT(result.error, !Contains("search"));
        CHECK_THAT(result.error,
                   Contains("warning") && Contains("fusion.toml:8: beacon.9.heading.mount_offset_deg = 20"));
      }
    }
  }
}

SCENARIO("a drive that shows nothing of what was asked for is an error") {
  const TemporaryFolder folder;
  const std::string log = write_drive(folder / "rest", "rest", 20.0);
  const auto settings = folder / "fusion.toml";
  const std::string before = "[outage]\nstale_after_s = 2.5\n";
  write_text(settings, before);
  const Result result = calibrate({"mount", log, "--write", settings.string()});
  CHECK(result.code == 1);
  CHECK(result.output.empty());
  CHECK_THAT(result.error, Contains("not observable") && Contains("accelerate"));
  CHECK(read_text(settings) == before);
}

SCENARIO("an invalid command line is refused before any file is read") {
  CHECK(calibrate({}).code != 0);
  CHECK(calibrate({"imu"}).code != 0);
  CHECK(calibrate({"imu", "log", "--beacon", "65535"}).code != 0);
  CHECK(calibrate({"magnetometer", "log", "--field-ut", "-1"}).code != 0);
  CHECK(calibrate({"allan", "log", "--out", "x"}).code != 0);
  CHECK_THAT(calibrate({"--help"}).output,
             Contains("magnetometer") && Contains("allan") && Contains("lever-arm"));
}

}  // namespace calibrate_test
