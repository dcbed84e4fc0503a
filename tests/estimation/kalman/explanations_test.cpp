#include <sonopose/estimation/kalman/explanations.hpp>

#include <catch2/catch.hpp>

#include <random>

namespace kalman_explanations_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

constexpr double std_m = 0.02;

Innovation innovation_of(const Vector3d& value_m) {
  Innovation innovation;
  innovation.value_world_m = value_m;
  innovation.covariance_m2 = std_m * std_m * Matrix3d::Identity();
  return innovation;
}

SCENARIO("the share of an innovation that is noise of the fixes") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, std_m);
  Correlation correlation;
  GIVEN("white innovations") {
    for (int i = 0; i < 200; ++i) {
      correlation.add(innovation_of({normal(random), normal(random), normal(random)}));
    }
    THEN("it is all") {
      CHECK(correlation.white_share() > 0.9);
    }
  }
  GIVEN("innovations of twice the noise that keep their sign for a second") {
    for (int i = 0; i < 200; ++i) {
      const double offset_m = (i / 10) % 2 == 0 ? 2.0 * std_m : -2.0 * std_m;
      correlation.add(innovation_of(Vector3d::Constant(offset_m) +
                                    Vector3d(normal(random), normal(random), normal(random))));
    }
    THEN("it is a small part") {
      CHECK(correlation.white_share() < 0.5);
    }
  }
}

SCENARIO("which fixes form another track") {
  constexpr TimeNs interval_ns = 100'000'000;
  constexpr double wrong_below = -4.0;
  const Matrix3d noise_m2 = std_m * std_m * Matrix3d::Identity();
  Explanations explanations;
  GIVEN("an offset that jumps and stays") {
    explanations.of_shift(interval_ns, Vector3d::Zero(), noise_m2);
    THEN("only the jump is unlikely") {
      CHECK(explanations.of_shift(2 * interval_ns, {1.0, 0.0, 0.0}, noise_m2) < wrong_below);
      for (int i = 3; i < 20; ++i) {
        CHECK(explanations.of_shift(i * interval_ns, {1.0, 0.0, 0.0}, noise_m2) > 0.0);
      }
    }
  }
  GIVEN("an offset that grows at 2 m/s²") {
    int unlikely = 0;
    for (int i = 1; i <= 20; ++i) {
      const double offset_m = 0.5 * 2.0 * (0.1 * i) * (0.1 * i);
      if (explanations.of_shift(i * interval_ns, {offset_m, 0.0, 0.0}, noise_m2) < wrong_below) ++unlikely;
    }
    THEN("again and again it leaves the track") {
      CHECK(unlikely >= 4);
    }
  }
}

}  // namespace kalman_explanations_test
