#include "calibration/fit/inertial_fit.hpp"

#include "calibration/fit/terms.hpp"
#include "calibration/simulated_sensor.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

namespace inertial_fit_test {

using namespace sonopose;
using namespace sonopose::calibration;
using namespace sonopose::calibration::fit;
using namespace sonopose::test;

AccelerometerSettings true_accelerometer() {
  AccelerometerSettings truth;
  truth.offset_x_mps2 = 0.25;
  truth.offset_y_mps2 = -0.15;
  truth.offset_z_mps2 = 0.4;
  truth.sensitivity_x = 1.02;
  truth.sensitivity_y = 0.97;
  truth.sensitivity_z = 1.01;
  truth.misalignment_yx = 0.02;
  truth.misalignment_zx = -0.015;
  truth.misalignment_zy = 0.01;
  return truth;
}

GyroscopeSettings true_gyroscope() {
  GyroscopeSettings truth;
  truth.offset_x_radps = 0.02;
  truth.offset_y_radps = -0.03;
  truth.offset_z_radps = 0.01;
  truth.sensitivity_x = 1.03;
  truth.sensitivity_y = 0.98;
  truth.sensitivity_z = 1.01;
  truth.misalignment_xy = 0.02;
  truth.misalignment_yz = -0.01;
  truth.misalignment_zx = 0.015;
  return truth;
}

/// M·s, computed independently of the library.
Eigen::Matrix3d matrix_of(const InertialTerms& terms) {
  Eigen::Matrix3d m;
  m << 1, terms.misalignment_xy, terms.misalignment_xz, terms.misalignment_yx, 1, terms.misalignment_yz,
      terms.misalignment_zx, terms.misalignment_zy, 1;
  return m * Eigen::DiagonalMatrix<double, 3>(terms.sensitivity_x, terms.sensitivity_y, terms.sensitivity_z);
}

SensorErrors errors_of(const AccelerometerSettings& accelerometer, const GyroscopeSettings& gyroscope = {}) {
  SensorErrors errors;
  errors.accel_gain = matrix_of(accelerometer).inverse();
  errors.accel_offset_mps2 = {accelerometer.offset_x_mps2, accelerometer.offset_y_mps2,
                              accelerometer.offset_z_mps2};
  errors.gyro_gain = matrix_of(gyroscope).inverse();
  errors.gyro_offset_radps = {gyroscope.offset_x_radps, gyroscope.offset_y_radps, gyroscope.offset_z_radps};
  return errors;
}

/// Checks that each setting is within 4.5 of its standard errors. The factor is large because there are only
/// 5 more residuals than parameters. The errors must be small enough to be useful, and 0 where nothing was
/// estimated.
template <class Group>
void check_recovered(const Group& found, const Group& errors, const Group& truth, double largest_error) {
  const auto values = terms_of(found);
  const auto standard_errors = terms_of(errors);
  const auto true_values = terms_of(truth);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double error = standard_errors[i].value;
    INFO(values[i].info->name << ": " << values[i].value << " ± " << error << ", truly "
                              << true_values[i].value);
    CHECK(std::abs(values[i].value - true_values[i].value) <= 4.5 * error);
    CHECK(error <= largest_error);
  }
}

TEST_CASE("GIVEN a MEMS accelerometer in 14 orientations THEN all nine of its errors are recovered") {
  const auto truth = true_accelerometer();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    const auto imu = SimulatedSensor(errors_of(truth), seed).hold_in_turn(sides_and_corners_of_a_cube());
    const auto fit = fit_accelerometer(find_still_intervals(imu));
    CHECK(fit.with_misalignment);
    CHECK(fit.orientations == 14);
    check_recovered(fit.settings, fit.standard_errors, truth, 0.005);
    // A mean over 1.4 s with 0.02 m/s² per sample is accurate to 0.002 m/s².
    CHECK(fit.rms_before_mps2 > 0.2);
    CHECK(fit.rms_after_mps2 < 0.004);
    CHECK(fit.worst_after_mps2 >= fit.rms_after_mps2);
  }
}

TEST_CASE("GIVEN the six sides alone THEN offset and sensitivity are recovered, and why no more is said") {
  auto truth = true_accelerometer();
  truth.misalignment_yx = truth.misalignment_zx = truth.misalignment_zy = 0.0;
  auto directions = sides_of_a_cube();
  directions.insert(directions.end(), {{0, 0, 1}, {1, 0, 0}});  // two of the six twice
  const auto imu = SimulatedSensor(errors_of(truth), 4).hold_in_turn(directions);
  const auto fit = fit_accelerometer(find_still_intervals(imu));
  CHECK_FALSE(fit.with_misalignment);
  CHECK(fit.why_without == "6 orientations were found, 9 are needed");
  CHECK(fit.settings.misalignment_yx == 0.0);
  check_recovered(fit.settings, fit.standard_errors, truth, 0.02);
}

TEST_CASE("too few orientations are an error that states how many were found and how many are needed") {
  const auto imu =
      SimulatedSensor(errors_of(true_accelerometer()), 5).hold_in_turn({{0, 0, 1}, {1, 0, 0}, {0, 1, 0}});
  const auto intervals = find_still_intervals(imu);
  CHECK_THROWS_WITH(fit_accelerometer(intervals),
                    Catch::Contains("3 found") && Catch::Contains("6 are needed"));
  CHECK_THROWS_AS(fit_accelerometer({}), CalibrationError);
}

TEST_CASE("orientations about one axis do not determine the offset along it") {
  std::vector<Vector3d> directions;
  for (int i = 0; i < 12; ++i) directions.emplace_back(std::cos(0.5 * i), std::sin(0.5 * i), 0.0);
  const auto imu = SimulatedSensor(errors_of(true_accelerometer()), 6).hold_in_turn(directions);
  CHECK_THROWS_WITH(fit_accelerometer(find_still_intervals(imu)),
                    Catch::Contains("do not determine") && Catch::Contains("of Z"));
}

TEST_CASE("an accelerometer in another unit than m/s^2 is refused by its sensitivity") {
  AccelerometerSettings truth;
  truth.sensitivity_x = truth.sensitivity_y = truth.sensitivity_z = 1000.0;  // in km/s²
  SensorErrors errors = errors_of(truth);
  errors.accel_noise_mps2 = 1e-5;
  const auto imu = SimulatedSensor(errors, 7).hold_in_turn(sides_and_corners_of_a_cube());
  CHECK_THROWS_WITH(fit_accelerometer(find_still_intervals(imu)), Catch::Contains("sensitivity_x"));
}

TEST_CASE("the gyroscope's offset is its mean at rest, in all periods together") {
  GyroscopeSettings truth;
  truth.offset_x_radps = 0.02;
  truth.offset_y_radps = -0.03;
  truth.offset_z_radps = 0.01;
  const auto imu = SimulatedSensor(errors_of({}, truth), 8).hold_in_turn(sides_of_a_cube());
  const auto fit = fit_gyroscope(find_still_intervals(imu));
  CHECK(fit.periods == 6);
  CHECK_FALSE(fit.with_sensitivity);
  check_recovered(fit.settings, fit.standard_errors, truth, 0.0003);
  CHECK_THROWS_WITH(fit_gyroscope({}), Catch::Contains("never still"));
}

TEST_CASE("GIVEN turns between 14 orientations THEN the gyroscope's sensitivities and axes are recovered") {
  const auto truth = true_gyroscope();
  const auto imu =
      SimulatedSensor(errors_of(true_accelerometer(), truth), 9).hold_in_turn(sides_and_corners_of_a_cube());
  const auto intervals = find_still_intervals(imu);
  const auto fit = fit_gyroscope(imu, intervals, fit_accelerometer(intervals).settings);
  CHECK(fit.with_sensitivity);
  CHECK(fit.turns == 13);
  check_recovered(fit.settings, fit.standard_errors, truth, 0.005);
  CHECK(fit.rms_before_rad > 0.02);
  CHECK(fit.rms_after_rad < 0.002);
}

TEST_CASE("turns about one axis do not determine the others, and then only the offset is estimated") {
  std::vector<Vector3d> directions;
  for (int i = 0; i < 12; ++i) directions.emplace_back(0.0, std::sin(0.9 * i), std::cos(0.9 * i));
  const auto imu = SimulatedSensor(errors_of({}, true_gyroscope()), 10).hold_in_turn(directions);
  const auto fit = fit_gyroscope(imu, find_still_intervals(imu), AccelerometerSettings{});
  CHECK_FALSE(fit.with_sensitivity);
  CHECK_THAT(fit.why_without, Catch::Contains("do not determine"));
  CHECK(fit.settings.sensitivity_x == 1.0);
  CHECK(fit.settings.offset_x_radps == Approx(0.02).margin(0.001));
}

TEST_CASE("GIVEN one wrong rate in a turn THEN that turn is excluded, and the result is correct") {
  const auto truth = true_gyroscope();
  const auto clean =
      SimulatedSensor(errors_of(true_accelerometer(), truth), 9).hold_in_turn(sides_and_corners_of_a_cube());
  const auto intervals = find_still_intervals(clean);
  const auto accelerometer = fit_accelerometer(intervals).settings;
  // Turn n lasts from 3·n + 2 s to 3·n + 3 s at 100 Hz.
  for (const std::size_t turn : {0U, 2U, 5U, 12U}) {
    for (const double wrong_radps : {35.0, -8.0, std::numeric_limits<double>::quiet_NaN()}) {
      CAPTURE(turn, wrong_radps);
      auto imu = clean;
      imu[300 * turn + 240].angular_velocity_body_radps.x() += wrong_radps;
      const auto fit = fit_gyroscope(imu, intervals, accelerometer);
      CHECK(fit.with_sensitivity);
      CHECK(fit.turns == 12);
      CHECK(fit.turns_left_out == (std::isfinite(wrong_radps) ? 1 : 0));
      check_recovered(fit.settings, fit.standard_errors, truth, 0.005);
      CHECK(fit.rms_after_rad < 0.002);
    }
  }
}

TEST_CASE("turns that disagree give the offset alone, and the reason") {
  const auto clean =
      SimulatedSensor(errors_of({}, true_gyroscope()), 12).hold_in_turn(sides_and_corners_of_a_cube());
  const auto intervals = find_still_intervals(clean);
  auto imu = clean;
  SECTION("five of thirteen have a wrong rate") {
    for (const std::size_t turn : {1U, 3U, 6U, 8U, 11U}) {
      imu[300 * turn + 240].angular_velocity_body_radps[static_cast<int>(turn % 3)] += 20.0;
    }
  }
  SECTION("all are too fast for the sensor's range") {
    for (ImuSample& sample : imu) {
      auto& rate_radps = sample.angular_velocity_body_radps;
      rate_radps = rate_radps.cwiseMax(-1.0).cwiseMin(1.0).eval();
    }
  }
  const auto fit = fit_gyroscope(imu, intervals, AccelerometerSettings{});
  CHECK_FALSE(fit.with_sensitivity);
  CHECK_THAT(fit.why_without,
             Catch::Contains("of them agree, 9 are needed") || Catch::Contains("degrees RMS"));
  CHECK(fit.settings.sensitivity_x == 1.0);
  CHECK(fit.settings.misalignment_xy == 0.0);
  CHECK(fit.settings.offset_x_radps == Approx(0.02).margin(0.001));
}

TEST_CASE("a sensitivity that no setting may have is not estimated, and said") {
  GyroscopeSettings truth;
  truth.offset_x_radps = 0.02;
  truth.sensitivity_x = truth.sensitivity_y = truth.sensitivity_z = 11.0;
  SensorErrors errors = errors_of({}, truth);
  errors.gyro_noise_radps = 0.0002;
  const auto imu = SimulatedSensor(errors, 13).hold_in_turn(sides_and_corners_of_a_cube());
  const auto fit = fit_gyroscope(imu, find_still_intervals(imu), AccelerometerSettings{});
  CHECK_FALSE(fit.with_sensitivity);
  CHECK_THAT(fit.why_without, Catch::Contains("calibration.gyroscope.sensitivity_x would be 11") ||
                                  Catch::Contains("calibration.gyroscope.sensitivity_x would be 10.9"));
  CHECK(fit.settings.sensitivity_x == 1.0);
  CHECK(fit.settings.offset_x_radps == Approx(0.02).margin(0.001));
}

}  // namespace inertial_fit_test
