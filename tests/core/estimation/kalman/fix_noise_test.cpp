#include <sonopose/estimation/kalman/fix_noise.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
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
      // Forty samples determine a deviation to 11 %.
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
  GIVEN("a fix whose prediction is worth nothing, and then one with a large residual") {
    MeasurementNoise noise;
    const double before_m = std::sqrt(noise.fix_covariance_m2(90.0)(0, 0));
    THEN("the first does not change the deviation, the second does at once") {
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
  const auto learn = [&](MeasurementNoise& noise, double std_m, bool at_rest, int fixes) {
    for (int i = 0; i < fixes; ++i) {
      noise.add_fix(90.0, std_m * Vector3d(normal(random), normal(random), normal(random)), Vector3d::Zero(),
                    at_rest);
    }
    return std::sqrt(noise.fix_covariance_m2(90.0)(0, 0));
  };
  GIVEN("a beacon that has not moved yet") {
    MeasurementNoise noise;
    const double before_m = std::sqrt(noise.fix_covariance_m2(90.0)(0, 0));
    CHECK(learn(noise, 0.001, true, 200) >= before_m);
    THEN("a large noise raises it") {
      CHECK(learn(noise, 0.15, true, 200) == Approx(0.15).epsilon(0.35));
    }
    THEN("the first fixes of its way show that it is small") {
      const double rest_std_m = GENERATE(0.001, 0.03);
      learn(noise, rest_std_m, true, 800);
      CHECK(learn(noise, 0.02, false, 40) < 0.03);
    }
  }
  GIVEN("a beacon that rested with a noise of 10 cm, and was moved slightly") {
    MeasurementNoise noise;
    learn(noise, 0.02, false, 200);
    CHECK(learn(noise, 0.1, true, 200) > 0.07);
    learn(noise, 0.02, false, 3);
    THEN("good fixes show that the noise is as small as before") {
      CHECK(learn(noise, 0.02, true, 1000) == Approx(0.02).epsilon(0.35));
    }
  }
  GIVEN("a beacon that rested with a noise of 10 cm, and moved for one fix") {
    MeasurementNoise noise;
    learn(noise, 0.1, true, 200);
    learn(noise, 0.02, false, 1);
    THEN("good fixes at rest show that the noise is no larger than at the start") {
      CHECK(learn(noise, 0.02, true, 1000) < 0.055);
    }
  }
  GIVEN("a beacon whose fixes were good for long, and now scatter by 20 cm so that they are rejected") {
    MeasurementNoise noise;
    learn(noise, 0.02, false, 400);
    for (int i = 0; i < 12; ++i) {
      noise.add_rejected_fix(90.0, 0.2 * Vector3d(normal(random), normal(random), normal(random)));
    }
    THEN("a dozen show that the noise is larger by far") {
      CHECK(std::sqrt(noise.fix_covariance_m2(90.0)(0, 0)) > 0.08);
      AND_THEN("good fixes show that it is small again, at rest as well") {
        CHECK(learn(noise, 0.02, GENERATE(false, true), 400) == Approx(0.02).epsilon(0.35));
      }
    }
  }
  for (const double moving_m : {0.015, 0.025, 0.15}) {
    GIVEN("a beacon that has moved, with a noise of (m) " << moving_m) {
      MeasurementNoise noise;
      const double before_m = learn(noise, moving_m, false, 200);
      REQUIRE(before_m == Approx(moving_m).epsilon(0.35));
      THEN("repeated fixes of a rest do not change what is known") {
        CHECK(learn(noise, 0.001, true, 200) == Approx(before_m));
      }
      THEN("the same noise at rest hardly raises it") {
        double sum = 0.0;
        for (int i = 0; i < 400; ++i) sum += learn(noise, moving_m, true, 10) / before_m;
        CHECK(sum / 400 < 1.08);
      }
      THEN("a noise three times as large raises it, until the fixes are good again") {
        CHECK(learn(noise, 3.0 * moving_m, true, 200) == Approx(3.0 * moving_m).epsilon(0.35));
        CHECK(learn(noise, moving_m, true, 1000) == Approx(moving_m).epsilon(0.35));
      }
    }
  }
}

SCENARIO("the headings of a body at rest do not show that their noise is small") {
  GIVEN("headings with a noise of 1.5° on the way") {
    MeasurementNoise noise;
    std::mt19937 random{9};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
    std::normal_distribution<double> normal(0.0, 0.026);
    for (int i = 0; i < 200; ++i) noise.add_heading(normal(random), 0.0, false);
    const double before_rad = std::sqrt(noise.heading_rad2.variance);
    REQUIRE(before_rad == Approx(0.026).epsilon(0.35));
    WHEN("the body rests for a minute, and the headings repeat") {
      for (int i = 0; i < 600; ++i) noise.add_heading(0.001, 0.0, true);
      THEN("the noise is as before") {
        CHECK(std::sqrt(noise.heading_rad2.variance) == Approx(before_rad));
      }
    }
  }
}

SCENARIO("the share of an innovation that is noise of the fixes") {
  constexpr double std_m = 0.02;
  const Matrix3d covariance_m2 = std_m * std_m * Matrix3d::Identity();
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, std_m);
  Correlation correlation;
  GIVEN("white innovations") {
    for (int i = 0; i < 200; ++i) {
      correlation.add({normal(random), normal(random), normal(random)}, covariance_m2);
    }
    THEN("it is all") {
      CHECK(correlation.white_share() > 0.9);
    }
  }
  GIVEN("innovations of twice the noise that keep their sign for a second") {
    for (int i = 0; i < 200; ++i) {
      const double offset_m = (i / 10) % 2 == 0 ? 2.0 * std_m : -2.0 * std_m;
      const Vector3d noise_m(normal(random), normal(random), normal(random));
      correlation.add(Vector3d::Constant(offset_m) + noise_m, covariance_m2);
    }
    THEN("it is a small part") {
      CHECK(correlation.white_share() < 0.5);
    }
  }
}

SCENARIO("fixes show their noise by themselves") {
  std::mt19937 random{9};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
  std::normal_distribution<double> normal;
  FixScatter scatter;
  constexpr double interval_s = 0.08;
  const auto add_circle = [&](const std::function<Vector3d(Vector3d)>& measure) {
    for (int i = 1; i <= 200; ++i) {
      const double angle_rad = i * interval_s;  // 2 m/s on a radius of 2 m: 2 m/s² towards the centre
      const Vector3d position_m(2.0 * std::cos(angle_rad), 2.0 * std::sin(angle_rad), 1.0);
      scatter.add(to_ns(i * interval_s), measure(position_m));
    }
  };
  GIVEN("a body in a curve, with a noise of 10 cm horizontally and of 40 cm vertically") {
    add_circle([&](const Vector3d& position_m) {
      return Vector3d(position_m +
                      Vector3d(0.1 * normal(random), 0.1 * normal(random), 0.4 * normal(random)));
    });
    THEN("the noise is between the limits") {
      const Vector3d min_m = scatter.noise_m2().cwiseSqrt();
      const Vector3d max_m = scatter.max_m2().cwiseSqrt();
      CHECK(min_m.x() < 0.1);
      CHECK(max_m.x() > 0.1);
      CHECK(max_m.x() < 0.4);
      CHECK(min_m.z() < 0.4);
      CHECK(min_m.z() > 0.15);
      CHECK(max_m.z() > 0.4);
    }
  }
  GIVEN("the same with one fix in ten on a reflection 3 m away") {
    add_circle([&](const Vector3d& position_m) {
      const bool is_reflected = std::uniform_real_distribution<double>()(random) < 0.1;
      return Vector3d(position_m + 0.02 * Vector3d(normal(random), normal(random), normal(random)) +
                      Vector3d(is_reflected ? 3.0 : 0.0, 0.0, 0.0));
    });
    THEN("the reflections do not count as noise") {
      CHECK(std::sqrt(scatter.max_m2().x()) < 0.2);
    }
  }
  GIVEN("coordinates that are rounded to 20 cm") {
    add_circle([](const Vector3d& position_m) { return Vector3d(0.2 * (position_m / 0.2).array().round()); });
    THEN("the noise is at least about that of the rounding, 20 cm / √12") {
      CHECK(std::sqrt(scatter.rounding_m2().x()) > 0.9 * 0.2 / std::sqrt(12.0));
    }
    THEN("a coordinate that never changed, whose error is always the same, counts less") {
      CHECK(scatter.rounding_m2().z() > 2.0 * scatter.rounding_m2().x());
    }
  }
  GIVEN("a body that stands, without noise") {
    for (int i = 1; i <= 50; ++i) scatter.add(to_ns(i * interval_s), {1.0, 2.0, 3.0});
    THEN("nothing shows that its coordinates are rounded") {
      CHECK(scatter.rounding_m2().isZero());
    }
  }
}

}  // namespace fix_noise_test
