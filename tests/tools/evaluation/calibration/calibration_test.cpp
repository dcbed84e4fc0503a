#include "evaluation/calibration/calibration.hpp"

#include "calibration/fit/error.hpp"
#include "calibration/fit/terms.hpp"
#include "calibration/simulated_sensor.hpp"
#include "evaluation/calibration/allan.hpp"
#include "files/error.hpp"
#include "plots/allan_plot.hpp"
#include "plots/plot.hpp"
#include "recording/log_writer.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <cstdlib>
#include <iostream>
#include <tuple>

namespace calibration_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using nlohmann::json;

void write_log(const std::filesystem::path& folder, const std::vector<ImuSample>& imu) {
  recording::SensorLogWriter writer(folder);
  for (const ImuSample& sample : imu) writer.write(sample);
  writer.flush();
}

/// A sensor held still in 14 orientations, with a magnetic field of random direction in each sample.
std::vector<ImuSample> whole_recording() {
  SensorErrors errors;
  errors.accel_gain(0, 0) = 1.02;
  errors.accel_offset_mps2 = {0.2, -0.1, 0.3};
  errors.gyro_offset_radps = {0.01, 0.02, -0.03};
  auto imu = SimulatedSensor(errors, 1).hold_in_turn(sides_and_corners_of_a_cube());
  sim::Random random(2);
  for (ImuSample& sample : imu) {
    const Vector3d direction = random.normal_vector().normalized();
    sample.magnetic_field_body_t =
        1e-6 * (48.0 * direction + Vector3d(10.0, -20.0, 30.0) + 0.3 * random.normal_vector());
  }
  return imu;
}

/// Checks that a table has exactly the group's settings, with exactly the same values.
template <class Group>
void check_table(const ::toml::table* table, const Group& settings) {
  REQUIRE(table != nullptr);
  const auto terms = calibration::fit::terms_of(settings);
  for (const auto& [info, value] : terms) {
    CAPTURE(info->name);
    CHECK((*table)[info->name].template value_exact<double>() == value);
  }
  CHECK(table->size() == terms.size());
}

TEST_CASE("the TOML tables contain every setting without loss") {
  const TemporaryFolder folder;
  write_log(folder / "log", whole_recording());
  const auto imu = evaluation::calibrate_imu(folder / "log");
  const auto field = evaluation::calibrate_magnetometer(folder / "log", {});
  REQUIRE(imu.accelerometer);
  REQUIRE(imu.gyroscope);
  REQUIRE(field.magnetometer);
  CHECK(imu.accelerometer->settings.sensitivity_x == Approx(1.0 / 1.02).epsilon(0.001));
  CHECK(imu.gyroscope->settings.offset_z_radps == Approx(-0.03).margin(0.0005));
  CHECK(field.magnetometer->settings.hard_iron_z_ut == Approx(30.0).margin(0.3));

  SECTION("for all beacons, with both files concatenated") {
    const auto tree =
        ::toml::parse(evaluation::calibration_toml(imu, {}) + evaluation::calibration_toml(field, {}));
    const auto tables = tree["calibration"];
    check_table(tables["accelerometer"].as_table(), imu.accelerometer->settings);
    check_table(tables["gyroscope"].as_table(), imu.gyroscope->settings);
    check_table(tree["documented"]["calibration"]["magnetometer"].as_table(), field.magnetometer->settings);
    CHECK(tree.size() == 2);
  }
  SECTION("for one beacon") {
    const auto tree = ::toml::parse(evaluation::calibration_toml(imu, BeaconAddress{12}));
    const auto tables = tree["beacon"]["12"]["calibration"];
    check_table(tables["accelerometer"].as_table(), imu.accelerometer->settings);
    CHECK(tree.size() == 1);
  }
  SECTION("the comments state the source") {
    const std::string text = evaluation::calibration_toml(imu, {});
    CHECK_THAT(text, Contains((folder / "log").string()) && Contains("4100 samples") &&
                         Contains("14 orientations") && Contains("RMS before"));
  }
  SECTION("the JSON object has the same values") {
    const json object = json::parse(evaluation::calibration_json(imu));
    CHECK(object["accelerometer"]["settings"]["offset_z_mps2"] == imu.accelerometer->settings.offset_z_mps2);
    CHECK(object["accelerometer"]["standard_errors"]["offset_z_mps2"].get<double>() > 0.0);
    CHECK(object["gyroscope"]["turns"] == 13);
    CHECK_FALSE(object.contains("magnetometer"));
    CHECK(json::parse(evaluation::calibration_json(field))["magnetometer"]["readings"] == 4100);
  }
}

TEST_CASE("a folder name with a line break or invalid UTF-8 keeps the TOML and the JSON valid") {
  const TemporaryFolder folder;
  const auto log = folder / "a\nb = 1\xff";
  write_log(log, whole_recording());
  const auto result = evaluation::calibrate_gyroscope(log);
  CHECK(json::parse(evaluation::calibration_json(result)).contains("gyroscope"));
  const std::string toml = evaluation::calibration_toml(result, {});
  CHECK_THAT(toml, !Contains("\nb = 1"));
  CHECK_NOTHROW(::toml::parse(toml));
}

TEST_CASE("a failed calibration names the file") {
  const TemporaryFolder folder;
  write_log(folder / "short", SimulatedSensor(SensorErrors{}, 3).hold_in_turn({{0, 0, 1}, {1, 0, 0}}));
  CHECK_THROWS_WITH(evaluation::calibrate_imu(folder / "short"),
                    Contains("short/imu.csv: ") && Contains("2 found"));
  CHECK_THROWS_WITH(evaluation::calibrate_magnetometer(folder / "short", {}),
                    Contains("short/imu.csv: 0 samples"));
  CHECK_THROWS_WITH(evaluation::analyse_allan(folder / "short"), Contains("short/imu.csv: "));
  CHECK_THROWS_AS(evaluation::calibrate_imu(folder / "none"), files::IoError);
  std::filesystem::create_directory(folder / "bad");
  write_text(folder / "bad/imu.csv",
             "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9.8\n2,0,0,x,0,0,9.8\n");
  CHECK_THROWS_WITH(evaluation::calibrate_imu(folder / "bad"), Contains("imu.csv:3") && Contains("x"));
  write_text(folder / "bad/imu.csv", "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n");
  CHECK_THROWS_AS(evaluation::calibrate_gyroscope(folder / "bad"), calibration::fit::CalibrationError);
}

TEST_CASE("the Allan deviation of a minute at rest is printed as text and JSON and plotted") {
  const TemporaryFolder folder;
  SimulatedSensor sensor(SensorErrors{}, 4);
  sensor.hold(Quaterniond::Identity(), 60.0);
  write_log(folder / "log", sensor.samples());
  const auto result = evaluation::analyse_allan(folder / "log");
  CHECK_THAT(evaluation::allan_text(result), Contains("6000 samples, 0.01 s apart") &&
                                                 Contains("gyroscope x") && Contains("accelerometer z") &&
                                                 Contains("not seen"));
  const json object = json::parse(evaluation::allan_json(result));
  REQUIRE(object["axes"].size() == 6);
  // 0.002 rad/s per sample at 100 Hz.
  CHECK(object["axes"][0]["noise_density"].get<double>() == Approx(0.0002).epsilon(0.1));
  CHECK(object["axes"][0]["rate_random_walk"].is_null());
  CHECK(object["axes"][5]["curve"][0][0].get<double>() == Approx(0.01));

  CHECK_THROWS_AS(plots::AllanPlot(folder / "a.pdf"), plots::PlotError);
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) {
    std::cout << "skipped: no gnuplot; scripts/setup test installs it\n";
    return;
  }
  plots::AllanPlot plot(folder / "a.svg");
  plot.draw(result);
  CHECK_THAT(read_text(folder / "a.svg"), Contains("Allan deviation of") && Contains("</svg>"));
}

}  // namespace calibration_test
