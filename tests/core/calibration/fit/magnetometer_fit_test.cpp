#include "calibration/fit/magnetometer_fit.hpp"

#include "calibration/fit/terms.hpp"
#include "sim/random.hpp"
#include <sonopose/calibration/model/calibration.hpp>

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace magnetometer_fit_test {

using namespace sonopose;
using namespace sonopose::calibration;
using namespace sonopose::calibration::fit;

constexpr double tesla_per_ut = 1e-6;

/// Distortion of a field by iron: raw = W·field + centre.
struct Iron {
  Matrix3d w = Matrix3d::Identity();
  Vector3d centre_ut = Vector3d::Zero();
  double noise_ut = 0.0;
};

const Iron usual_iron{.w = Matrix3d{{1.10, 0.04, -0.03}, {0.04, 0.92, 0.05}, {-0.03, 0.05, 1.03}},
                      .centre_ut = {20.0, -35.0, 12.0},
                      .noise_ut = 0.4};

/// Readings of a field of `strength_ut` in those random directions that `seen` accepts.
std::vector<ImuSample> readings(
    const Iron& iron, double strength_ut, std::uint64_t seed, int count = 4000,
    const std::function<bool(const Vector3d&)>& seen = [](const Vector3d& /*direction*/) { return true; }) {
  sim::Random random(seed);
  std::vector<ImuSample> imu;
  while (static_cast<int>(imu.size()) < count) {
    const Vector3d direction = random.normal_vector().normalized();
    if (!seen(direction)) continue;
    const Vector3d field_ut = iron.w * (strength_ut * direction) + iron.centre_ut;
    imu.emplace_back().magnetic_field_body_t =
        tesla_per_ut * (field_ut + iron.noise_ut * random.normal_vector());
  }
  return imu;
}

TEST_CASE("h = S·c: a sphere of 50 uT about (10, -20, 30), stretched to double along Z, by hand") {
  // The semi-axes are 50, 50 and 100 µT. A true field of 50 µT gives S = diag(1, 1, 1/2) and h = (10, −20,
  // 15).
  const Iron iron{.w = Vector3d(1.0, 1.0, 2.0).asDiagonal(), .centre_ut = {10.0, -20.0, 30.0}};
  const auto fit = fit_magnetometer(readings(iron, 50.0, 1), 50.0);
  CHECK(fit.settings.soft_iron_xx == Approx(1.0).margin(1e-9));
  CHECK(fit.settings.soft_iron_yy == Approx(1.0).margin(1e-9));
  CHECK(fit.settings.soft_iron_zz == Approx(0.5).margin(1e-9));
  CHECK(fit.settings.soft_iron_xy == Approx(0.0).margin(1e-9));
  CHECK(fit.settings.soft_iron_xz == Approx(0.0).margin(1e-9));
  CHECK(fit.settings.soft_iron_yz == Approx(0.0).margin(1e-9));
  CHECK(fit.settings.hard_iron_x_ut == Approx(10.0).margin(1e-7));
  CHECK(fit.settings.hard_iron_y_ut == Approx(-20.0).margin(1e-7));
  CHECK(fit.settings.hard_iron_z_ut == Approx(15.0).margin(1e-7));
  CHECK((fit.centre_ut - iron.centre_ut).norm() < 1e-6);
  CHECK((fit.semi_axes_ut - Vector3d(100.0, 50.0, 50.0)).norm() < 1e-6);
  CHECK(fit.rms_before_ut > 10.0);
  CHECK(fit.rms_after_ut < 1e-7);
}

TEST_CASE("GIVEN noise and iron THEN the ellipsoid's centre and axes come out within their errors") {
  const double strength_ut = 48.0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    const auto fit = fit_magnetometer(readings(usual_iron, strength_ut, seed), strength_ut);
    // The symmetric inverse of the symmetric W is S; h = S·c.
    const Matrix3d s = usual_iron.w.inverse();
    const Vector3d h_ut = s * usual_iron.centre_ut;
    MagnetometerSettings truth;
    truth.soft_iron_xx = s(0, 0);
    truth.soft_iron_xy = s(0, 1);
    truth.soft_iron_xz = s(0, 2);
    truth.soft_iron_yy = s(1, 1);
    truth.soft_iron_yz = s(1, 2);
    truth.soft_iron_zz = s(2, 2);
    truth.hard_iron_x_ut = h_ut.x();
    truth.hard_iron_y_ut = h_ut.y();
    truth.hard_iron_z_ut = h_ut.z();
    const auto values = terms_of(fit.settings);
    const auto errors = terms_of(fit.standard_errors);
    const auto true_values = terms_of(truth);
    for (std::size_t i = 0; i < values.size(); ++i) {
      INFO(values[i].info->name);
      CHECK(std::abs(values[i].value - true_values[i].value) <= 4.0 * errors[i].value);
      CHECK(errors[i].value < 0.1);
    }
    CHECK(fit.rms_after_ut == Approx(usual_iron.noise_ut).epsilon(0.15));
    CHECK(fit.coverage == 1.0);
    CHECK(fit.samples == 4000);
  }
}

TEST_CASE("without a wanted strength the ellipsoid keeps its volume, and the field gets its direction back") {
  const auto imu = readings(usual_iron, 48.0, 4);
  const auto fit = fit_magnetometer(imu);
  CHECK(fit.field_ut == Approx(48.0 * std::cbrt(usual_iron.w.determinant())).epsilon(0.003));
  Settings settings;
  settings.magnetometer = fit.settings;
  const Calibration calibration(settings);
  ImuSample sample;
  const Vector3d true_ut{10.0, 30.0, -36.0};
  sample.magnetic_field_body_t = tesla_per_ut * (usual_iron.w * true_ut + usual_iron.centre_ut);
  const Vector3d corrected_t = calibration.corrected(sample).magnetic_field_body_t.value();
  CHECK(corrected_t.norm() / tesla_per_ut == Approx(fit.field_ut).epsilon(0.01));
  CHECK(corrected_t.normalized().dot(true_ut.normalized()) > std::cos(0.01));
}

TEST_CASE("a long rest on a table with a little iron changes little") {
  auto imu = readings(usual_iron, 48.0, 5);
  const auto clean = fit_magnetometer(imu, 48.0);
  ImuSample rest = imu.front();
  *rest.magnetic_field_body_t += 1.2 * tesla_per_ut * (rest.magnetic_field_body_t->normalized());
  imu.insert(imu.end(), 20'000, rest);
  const auto fit = fit_magnetometer(imu, 48.0);
  CHECK(fit.samples == 24'000);
  CHECK((fit.centre_ut - clean.centre_ut).norm() < 0.05);
}

TEST_CASE("a magnet passing by is left out") {
  auto imu = readings(usual_iron, 48.0, 5);
  const auto clean = fit_magnetometer(imu, 48.0);
  for (std::size_t i = 100; i < 150; ++i) {
    *imu[i].magnetic_field_body_t += tesla_per_ut * Vector3d(15.0, 9.0, 4.0);
  }
  const auto fit = fit_magnetometer(imu, 48.0);
  CHECK(fit.outliers >= 20);
  CHECK((fit.centre_ut - clean.centre_ut).norm() < 0.05);
}

TEST_CASE("a glitch among thousands of readings is left out and counted, and changes nothing else") {
  const auto imu = readings(usual_iron, 48.0, 11, 9000);
  const auto clean = fit_magnetometer(imu, 48.0);
  for (const double glitch_ut : {300.0, 2000.0, 5000.0, 1e9, 1e20, 1e300}) {
    for (const Vector3d& direction : {Vector3d(1.0, 0.0, 0.0), Vector3d(0.5, -1.0, 1.0)}) {
      CAPTURE(glitch_ut, direction.transpose());
      auto with_glitch = imu;
      ImuSample glitch = imu.front();
      glitch.magnetic_field_body_t = glitch_ut * tesla_per_ut * direction;
      with_glitch.insert(with_glitch.begin() + 1234, glitch);
      const auto fit = fit_magnetometer(with_glitch, 48.0);
      CHECK((fit.centre_ut - clean.centre_ut).norm() < 1e-9);
      CHECK((fit.semi_axes_ut - clean.semi_axes_ut).norm() < 1e-9);
      CHECK(fit.coverage == clean.coverage);
      CHECK(fit.samples == clean.samples + 1);
      CHECK(fit.used == clean.used);
      CHECK(fit.outliers == clean.outliers + 1);
    }
  }
}

TEST_CASE("glitches in one of thirty readings are left out as well") {
  auto imu = readings(usual_iron, 48.0, 12);
  const auto clean = fit_magnetometer(imu, 48.0);
  ImuSample glitch = imu.front();
  glitch.magnetic_field_body_t = tesla_per_ut * Vector3d(2000.0, -2000.0, 2000.0);
  imu.insert(imu.begin() + 2000, imu.size() / 30, glitch);
  const auto fit = fit_magnetometer(imu, 48.0);
  CHECK((fit.centre_ut - clean.centre_ut).norm() < 1e-9);
  CHECK(fit.outliers == clean.outliers + 4000 / 30);
}

TEST_CASE("a magnet on the sensor is taken off, though it is ten times as strong as the field") {
  Iron iron = usual_iron;
  iron.centre_ut = {400.0, -250.0, 100.0};
  const auto fit = fit_magnetometer(readings(iron, 48.0, 9));
  CHECK((fit.centre_ut - iron.centre_ut).norm() < 0.2);
  CHECK(fit.field_ut == Approx(48.0 * std::cbrt(iron.w.determinant())).epsilon(0.003));
  CHECK(fit.used > 2000);
}

TEST_CASE("half a sphere is enough") {
  const auto imu = readings(usual_iron, 48.0, 6, 4000, [](const Vector3d& d) { return d.z() > 0.0; });
  const auto fit = fit_magnetometer(imu, 48.0);
  CHECK((fit.centre_ut - usual_iron.centre_ut).norm() < 1.0);
  CHECK(fit.coverage < 0.7);
}

TEST_CASE("directions in one plane, or about one spot, are refused with what they are short of") {
  const auto all_round_z = [](const Vector3d& d) { return std::abs(d.z()) < 0.03; };
  const auto about_x = [](const Vector3d& d) { return d.x() > 0.9; };
  for (const std::function<bool(const Vector3d&)>& seen :
       {std::function<bool(const Vector3d&)>(all_round_z), std::function<bool(const Vector3d&)>(about_x)}) {
    const auto imu = readings(usual_iron, 48.0, 7, 2000, seen);
    CHECK_THROWS_WITH(fit_magnetometer(imu), Catch::Contains("do not determine the ellipsoid") &&
                                                 Catch::Contains("% of the sphere"));
  }
}

TEST_CASE("a magnet that is put on halfway is seen in the residuals, and the field does not vanish") {
  auto imu = readings(usual_iron, 48.0, 10);
  for (std::size_t i = imu.size() / 2; i < imu.size(); ++i) {
    imu[i].magnetic_field_body_t->z() += 16.0 * tesla_per_ut;
  }
  const auto fit = fit_magnetometer(imu);
  CHECK(fit.rms_after_ut > 2.0);
  CHECK(fit.field_ut == Approx(48.0 * std::cbrt(usual_iron.w.determinant())).epsilon(0.1));
  CHECK(fit.coverage == 1.0);
}

TEST_CASE("readings on no ellipsoid are refused") {
  // Field strengths from 20 to 100 µT in random directions fill a ball instead of its surface.
  sim::Random random(8);
  std::vector<ImuSample> imu(3000);
  for (auto& sample : imu) {
    const Vector3d direction = random.normal_vector().normalized();
    sample.magnetic_field_body_t = tesla_per_ut * random.uniform_in({20.0, 100.0}) * direction;
  }
  CHECK_THROWS_WITH(fit_magnetometer(imu), Catch::Contains("lie on no ellipsoid"));
}

TEST_CASE("a recording without a field, with a field of zero, or with the same one all the time is refused") {
  CHECK_THROWS_WITH(fit_magnetometer(std::vector<ImuSample>(1000)),
                    Catch::Contains("0 samples have a magnetic field"));
  std::vector<ImuSample> imu(1000);
  for (auto& sample : imu) sample.magnetic_field_body_t = Vector3d::Zero();
  CHECK_THROWS_AS(fit_magnetometer(imu), CalibrationError);
  for (auto& sample : imu) sample.magnetic_field_body_t = Vector3d(1e-5, 2e-5, 3e-5);
  CHECK_THROWS_AS(fit_magnetometer(imu), CalibrationError);
  for (auto& sample : imu) sample.magnetic_field_body_t->setConstant(std::numeric_limits<double>::infinity());
  CHECK_THROWS_AS(fit_magnetometer(imu), CalibrationError);
}

}  // namespace magnetometer_fit_test
