#include <sonopose/estimation/kalman/fix_noise.hpp>

#include <catch2/catch.hpp>

#include <random>

namespace fix_noise_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

SCENARIO("the noise of fixes is learned for each range of the quality") {
  GIVEN("residuals of 1 cm horizontally and 4 cm vertically at 90 %, with an exact prediction") {
    MeasurementNoise noise;
    const double before_m2 = noise.fix_covariance_m2(65.0)(0, 0);
    std::mt19937 random{5};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
    std::normal_distribution<double> normal;
    for (int i = 0; i < 2000; ++i) {
      noise.add_fix(90.0, {0.01 * normal(random), 0.01 * normal(random), 0.04 * normal(random)},
                    Vector3d::Zero());
    }
    THEN("the deviations are those, and other qualities keep theirs") {
      const auto covariance_m2 = noise.fix_covariance_m2(95.0);
      // Forty samples know a deviation to 11 %.
      CHECK(std::sqrt(covariance_m2(0, 0)) == Approx(0.01).epsilon(0.35));
      CHECK(std::sqrt(covariance_m2(2, 2)) == Approx(0.04).epsilon(0.35));
      CHECK(noise.fix_covariance_m2(65.0)(0, 0) == before_m2);
    }
  }
  GIVEN("a residual of a metre") {
    MeasurementNoise noise;
    noise.add_fix(90.0, {1.0, 1.0, 1.0}, Vector3d::Zero());
    THEN("one stray fix does not double the deviation") {
      CHECK(std::sqrt(noise.fix_covariance_m2(90.0)(0, 0)) < 0.04);
    }
  }
}

}  // namespace fix_noise_test
