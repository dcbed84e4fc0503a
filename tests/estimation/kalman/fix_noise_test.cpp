#include <sonopose/estimation/kalman/fix_noise.hpp>

#include <catch2/catch.hpp>

#include <random>

namespace fix_noise_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

SCENARIO("the noise of fixes is learned for each range of the quality") {
  GIVEN("residuals of 5 cm at 65 %, and of 1 cm horizontally and 4 cm vertically at 90 %") {
    MeasurementNoise noise;
    std::mt19937 random{5};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
    std::normal_distribution<double> normal;
    const auto add = [&](double quality_percent, double horizontal_m, double vertical_m) {
      noise.add_fix(
          quality_percent,
          {horizontal_m * normal(random), horizontal_m * normal(random), vertical_m * normal(random)},
          Vector3d::Zero(), false);
    };
    for (int i = 0; i < 200; ++i) add(65.0, 0.05, 0.05);
    for (int i = 0; i < 2000; ++i) add(90.0, 0.01, 0.04);
    THEN("the deviations are those, and a quality that was not seen is like the recent fixes") {
      // Forty samples know a deviation to 11 %.
      CHECK(std::sqrt(noise.fix_covariance_m2(95.0)(0, 0)) == Approx(0.01).epsilon(0.35));
      CHECK(std::sqrt(noise.fix_covariance_m2(95.0)(2, 2)) == Approx(0.04).epsilon(0.35));
      CHECK(std::sqrt(noise.fix_covariance_m2(65.0)(0, 0)) == Approx(0.05).epsilon(0.35));
      CHECK(std::sqrt(noise.fix_covariance_m2(75.0)(0, 0)) == Approx(0.01).epsilon(0.35));
    }
  }
  GIVEN("a residual of a metre after a few usual ones") {
    MeasurementNoise noise;
    for (int i = 0; i < 10; ++i) noise.add_fix(90.0, {0.02, 0.02, 0.02}, Vector3d::Zero(), false);
    const double before_m = std::sqrt(noise.fix_covariance_m2(90.0)(0, 0));
    noise.add_fix(90.0, {1.0, 1.0, 1.0}, Vector3d::Zero(), false);
    THEN("one stray fix does not double the deviation") {
      CHECK(std::sqrt(noise.fix_covariance_m2(90.0)(0, 0)) < 2.0 * before_m);
    }
  }
  GIVEN("a first fix with a large residual, and one whose prediction is worth nothing") {
    MeasurementNoise noise;
    const double before_m = std::sqrt(noise.fix_covariance_m2(90.0)(0, 0));
    THEN("the first changes the deviation at once, the second does not") {
      noise.add_fix(90.0, {0.0, 0.0, 0.0}, Vector3d::Constant(before_m * before_m), false);
      CHECK(std::sqrt(noise.fix_covariance_m2(90.0)(0, 0)) == before_m);
      noise.add_fix(90.0, {0.1, 0.1, 0.1}, Vector3d::Zero(), false);
      CHECK(std::sqrt(noise.fix_covariance_m2(90.0)(0, 0)) > 1.5 * before_m);
    }
  }
}

SCENARIO("a body at rest may show that the noise is large, but not that it is small") {
  std::mt19937 random{7};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
  std::normal_distribution<double> normal;
  const auto learn = [&](MeasurementNoise& noise, double std_m, bool at_rest) {
    for (int i = 0; i < 200; ++i) {
      noise.add_fix(90.0, std_m * Vector3d(normal(random), normal(random), normal(random)), Vector3d::Zero(),
                    at_rest);
    }
    return std::sqrt(noise.fix_covariance_m2(90.0)(0, 0));
  };
  GIVEN("a beacon that has not moved yet") {
    MeasurementNoise noise;
    const double before_m = std::sqrt(noise.fix_covariance_m2(90.0)(0, 0));
    CHECK(learn(noise, 0.001, true) >= before_m);
    CHECK(learn(noise, 0.15, true) == Approx(0.15).epsilon(0.35));
  }
  GIVEN("a beacon that has moved") {
    MeasurementNoise noise;
    const double moving_m = learn(noise, 0.02, false);
    REQUIRE(moving_m == Approx(0.02).epsilon(0.35));
    CHECK(learn(noise, 0.001, true) >= moving_m);
  }
}

}  // namespace fix_noise_test
