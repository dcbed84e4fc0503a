/// Filters over attitude logs: scores of known errors, and accuracy on real recordings.

#include "evaluation/replay/attitude_run.hpp"

#include "support/recordings.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

namespace attitude_run_test {

using namespace sonopose;
using evaluation::AttitudeResult;

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

/// A body at rest for 10 s whose truth is rotated by `off` relative to its sensors.
recording::AttitudeLog standing(const Quaterniond& off) {
  recording::AttitudeLog log;
  for (int i = 0; i <= 1000; ++i) {
    ImuSample imu;
    imu.sensor_time_ns = start_ns + i * 10'000'000LL;
    imu.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
    log.imu.push_back(imu);
    TruthSample truth;
    truth.time_ns = imu.sensor_time_ns;
    truth.q_body_to_world = off;
    log.truth.push_back(truth);
  }
  return log;
}

constexpr double degree = geometry::radians_per_degree;

TEST_CASE("heading and inclination errors are separated, and both are part of the total error") {
  const auto scored = [](const Quaterniond& off) {
    return evaluation::run_attitude("log", standing(off), {});
  };
  const AttitudeResult turned = scored(geometry::rotation_about_z(30 * degree));
  CHECK(turned.scored == 1001);
  CHECK(turned.heading_rmse_deg == Approx(30.0));
  CHECK(turned.inclination_rmse_deg == Approx(0.0).margin(1e-4));
  CHECK(turned.total_rmse_deg == Approx(30.0));
  const AttitudeResult leaning = scored(geometry::rotation_by({20 * degree, 0, 0}));
  CHECK(leaning.heading_rmse_deg == Approx(0.0).margin(1e-4));
  CHECK(leaning.inclination_rmse_deg == Approx(20.0));
  CHECK(leaning.total_rmse_deg == Approx(20.0));
}

TEST_CASE("only movements with a known truth are scored, and an invalid sample is counted") {
  recording::AttitudeLog log = standing(geometry::rotation_about_z(1.0));
  log.movements = {{start_ns + 2'000'000'000, start_ns + 3'000'000'000}};
  log.truth.resize(251);  // up to 2.5 s
  log.imu[700].specific_force_body_mps2.x() = std::nan("");
  log.imu[120].angular_velocity_body_radps.x() = 1e200;
  const AttitudeResult result = evaluation::run_attitude("log", log, {});
  CHECK(result.scored == 51);
  CHECK(result.samples == 1001);
  CHECK(result.rejected == 2);
  CHECK(result.heading_rmse_deg == Approx(1.0 / degree));
}

TEST_CASE("an invalid orientation does not have zero error") {
  const double nan = std::nan("");
  const auto error = evaluation::error_of({nan, nan, nan, nan}, Quaterniond::Identity());
  CHECK(std::isnan(error.total_rad));
  CHECK(std::isnan(error.heading_rad));
  CHECK(std::isnan(error.inclination_rad));
}

TEST_CASE("without truth the errors are unknown, and the mean excludes that log") {
  recording::AttitudeLog log = standing(geometry::rotation_about_z(10 * degree));
  const AttitudeResult known = evaluation::run_attitude("known", log, {});
  log.truth.clear();
  const AttitudeResult unknown = evaluation::run_attitude("unknown", log, {});
  CHECK(unknown.scored == 0);
  CHECK(std::isnan(unknown.total_rmse_deg));
  const AttitudeResult mean = evaluation::mean_of({known, unknown});
  CHECK(mean.scored == 1);
  CHECK(mean.heading_rmse_deg == Approx(10.0));
  const auto json = nlohmann::json::parse(evaluation::attitude_json({known, unknown}));
  CHECK(json["logs"][1]["total_rmse_deg"].is_null());
  CHECK(json["mean"]["heading_rmse_deg"].get<double>() == Approx(10.0));
  CHECK(evaluation::attitude_text({known, unknown}).find("unknown") != std::string::npos);
}

/// The ten recorded trials; empty if they are missing.
const std::vector<recording::AttitudeLog>& trials() {
  static std::vector<recording::AttitudeLog> logs;
  const std::filesystem::path folder = std::filesystem::path(SONOPOSE_RECORDINGS) / "attitude";
  if (!test::is_here(folder) || !logs.empty()) return logs;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_directory()) logs.push_back(recording::read_attitude_log(entry.path()));
  }
  return logs;
}

AttitudeResult mean_over_trials(settings::Settings settings, bool magnetometer) {
  settings.attitude.selection.magnetometer = magnetometer;
  std::vector<AttitudeResult> results;
  for (const recording::AttitudeLog& log : trials())
    results.push_back(evaluation::run_attitude("", log, settings));
  return evaluation::mean_of(results);
}

TEST_CASE("recorded trials: the classic Mahony filter reproduces the benchmark's score") {
  if (trials().empty()) return;
  REQUIRE(trials().size() == 10);
  settings::Settings settings;
  settings.attitude.selection.filter = attitude::FilterKind::mahony;
  settings.attitude.mahony.kp = 0.74;
  settings.attitude.mahony.ki = 0.0012;
  settings.attitude.mahony.ki_gate_mps2 = 1000;
  settings.attitude.mahony.magnetic_error = attitude::MagneticError::full;
  CHECK(mean_over_trials(settings, true).total_rmse_deg == Approx(8.98).margin(0.1));
  CHECK(mean_over_trials(settings, false).inclination_rmse_deg == Approx(3.12).margin(0.1));
}

TEST_CASE("recorded trials: the AHRS is as accurate as its reference library") {
  if (trials().empty()) return;
  settings::Settings settings;
  settings.attitude.selection.filter = attitude::FilterKind::ahrs;
  CHECK(mean_over_trials(settings, true).total_rmse_deg < 10.82);
  CHECK(mean_over_trials(settings, false).inclination_rmse_deg < 3.82);
}

TEST_CASE("recorded trials: the default filter is as accurate as the best public filter") {
  if (trials().empty()) return;
  CHECK(mean_over_trials({}, false).inclination_rmse_deg < 0.8);
  const AttitudeResult with_field = mean_over_trials({}, true);
  CHECK(with_field.total_rmse_deg < 2.67);
  CHECK(with_field.inclination_rmse_deg < 0.8);
}

}  // namespace attitude_run_test
