/// Errors of the fixes that last for seconds, which a filter follows: its covariance covers them.

#include "sim/random.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/seeds.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>
#include <variant>

namespace kalman_slow_error_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
constexpr double noise_m = 0.02;
const Eigen::Matrix3d noise_m2 = noise_m * noise_m * Eigen::Matrix3d::Identity();

/// Fixes with white noise, and in their innovations a sinusoid of an amplitude along all axes.
struct Fixes {
  double interval_s = 0.1;
  double amplitude_m = 0;
  bool moves = true;
};

/// Adds fixes. Returns the mean of the variance after each.
double add(SlowErrorDetector& detector, sim::Random& random, double duration_s, const Fixes& fixes) {
  const TimeNs from_ns = detector.seen_ns == 0 ? begin_ns : detector.seen_ns;
  double sum_m2 = 0;
  int count = 0;
  for (double time_s = fixes.interval_s; time_s < duration_s; time_s += fixes.interval_s) {
    const double slow_m = fixes.amplitude_m * std::sin(1.2 * time_s);
    const Vector3d white_m(random.normal(), random.normal(), random.normal());
    detector.add(from_ns + to_ns(time_s), Vector3d::Constant(slow_m) + noise_m * white_m, noise_m2, noise_m2,
                 fixes.moves);
    sum_m2 += detector.variance_m2(0.0, 0.0);
    ++count;
  }
  return sum_m2 / count;
}

SCENARIO("white innovations show no slow error, whatever their rate") {
  GIVEN("ten minutes of them") {
    const double interval_s = GENERATE(0.05, 0.1, 0.5);
    CAPTURE(interval_s);
    SlowErrorDetector detector;
    sim::Random random(1);
    const double mean_m2 = add(detector, random, 600.0, {.interval_s = interval_s});
    THEN("the variance is on average a small part of the noise") {
      CHECK(mean_m2 < 0.05 * noise_m * noise_m);
    }
  }
}

SCENARIO("correlated innovations show a slow error that is larger") {
  GIVEN("innovations that are a sinusoid of 5 cm, beside their noise") {
    SlowErrorDetector detector;
    sim::Random random(1);
    add(detector, random, 30.0, {.amplitude_m = 0.05});
    const double variance_m2 = detector.variance_m2(0.0, 0.0);
    THEN("the error is more than that, because the filter follows most of it") {
      CHECK(std::sqrt(variance_m2) > 0.05);
      CHECK(std::sqrt(variance_m2) < 0.2);
      AND_THEN("vibration of the IMU that is strong enough explains it instead") {
        CHECK(detector.variance_m2(0.15, 0.0) == 0.0);
        CHECK(detector.variance_m2(0.0, 0.01) == 0.0);
      }
    }
    WHEN("the body stands still, where its error stays") {
      add(detector, random, 30.0, {.moves = false});
      THEN("so does the variance") {
        CHECK(detector.variance_m2(0.0, 0.0) == Approx(variance_m2));
      }
    }
    WHEN("the body moves on without it") {
      add(detector, random, 15.0, {});
      THEN("it fades within seconds") {
        CHECK(detector.variance_m2(0.0, 0.0) < 0.1 * variance_m2);
      }
    }
  }
}

SCENARIO("the first fix after an outage shows the drift meanwhile, and no error of the fixes") {
  SlowErrorDetector detector;
  sim::Random random(2);
  add(detector, random, 30.0, {});
  detector.add(detector.seen_ns + to_ns(10.0), Vector3d(1.5, 0, 0), noise_m2, noise_m2, true);
  CHECK(detector.mean_world_m.isZero(0.0));
  CHECK(add(detector, random, 10.0, {}) < 0.1 * noise_m * noise_m);
}

SCENARIO("an axis of the fixes that is unknown says nothing") {
  SlowErrorDetector detector;
  Eigen::Matrix3d unknown_m2 = noise_m2;
  unknown_m2(1, 1) = unknown_m2(2, 2) = 1e308;
  for (int i = 0; i < 300; ++i) {
    const double slow_m = 0.05 * std::sin(0.12 * i);
    detector.add(begin_ns + to_ns(0.1 * i), Vector3d(slow_m, 50.0, 50.0), unknown_m2, unknown_m2, true);
  }
  CHECK(std::sqrt(detector.variance_m2(0.0, 0.0)) > 0.05);
  CHECK(std::sqrt(detector.variance_m2(0.0, 0.0)) < 0.2);
}

/// Errors over their standard deviations.
struct Coverage {
  int poses = 0;
  int beyond_position = 0;  ///< position errors above five standard deviations
  int beyond_velocity = 0;
  double squared_error_m2 = 0;
  double variance_m2 = 0;

  [[nodiscard]] double std_over_rms() const { return std::sqrt(variance_m2 / squared_error_m2); }
};

bool is_beyond(const Covariance<3>::Matrix& covariance, const Vector3d& error) {
  return error.dot(covariance.llt().solve(error)) > 25.0;
}

/// Adds a run, from 20 s on: earlier the biases of the IMU are not known well enough.
void add_run(Coverage& coverage, const sim::Scenario& scenario, std::uint64_t seed) {
  sim::Simulator simulator(scenario, {.seed = seed, .duration_s = 60.0});
  Engine engine{settings::Settings{}};
  TimeNs first_ns = 0;
  while (const auto step = simulator.next()) {
    const auto result = estimation::process(engine, step->event);
    const auto* const pose = std::get_if<FusedPose>(&result);
    if (pose == nullptr || !step->truth) continue;
    if (first_ns == 0) first_ns = pose->time_ns;
    if (seconds_between(first_ns, pose->time_ns) < 20.0) continue;
    const Eigen::Matrix3d position_m2 = pose->pose_covariance.matrix().topLeftCorner<3, 3>();
    const Vector3d error_m = pose->position_world_m - step->truth->position_world_m;
    ++coverage.poses;
    coverage.beyond_position += is_beyond(position_m2, error_m) ? 1 : 0;
    coverage.beyond_velocity += is_beyond(pose->velocity_covariance.matrix(),
                                          pose->velocity_world_mps - step->truth->velocity_world_mps)
                                    ? 1
                                    : 0;
    coverage.squared_error_m2 += error_m.squaredNorm();
    coverage.variance_m2 += position_m2.trace();
  }
}

void check_covered(const Coverage& coverage) {
  CHECK(coverage.beyond_position < 0.01 * coverage.poses);
  CHECK(coverage.beyond_velocity < 0.01 * coverage.poses);
  CHECK(coverage.std_over_rms() < 3.0);
}

SCENARIO("the covariance covers an error of the map by place", "[accuracy]") {
  GIVEN("a walk, and a drone, through fixes that are up to 14 cm off in waves of 5 m") {
    const std::string_view name = GENERATE("walk", "drone");
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= test::seeds(4, 20); ++seed) {
      sim::Random random(seed);
      sim::Scenario scenario = sim::find_scenario(name);
      scenario.disturbances.bias_field = {
          .amplitude_world_m = 0.14 * random.direction(),
          .wave_radpm = 2.0 * std::numbers::pi / 5.0 * random.horizontal_direction(),
          .phase_rad = random.uniform_in({-std::numbers::pi, std::numbers::pi})};
      add_run(coverage, scenario, seed);
    }
    fmt::print("{} through a bias field: {} of {} poses beyond 5 sigma, sigma / error {:.2f}\n", name,
               coverage.beyond_position, coverage.poses, coverage.std_over_rms());
    THEN("the error exceeds five standard deviations in less than 1 % of the poses") {
      check_covered(coverage);
    }
  }
}

SCENARIO("the covariance covers a wrong latency", "[accuracy]") {
  GIVEN("a kart at 6 m/s whose fixes are 8 ms older or younger than reported") {
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= test::seeds(4, 20); ++seed) {
      sim::Scenario scenario = sim::find_scenario("kart");
      scenario.sensors.reported_delay_error_s = seed % 2 == 0 ? 0.008 : -0.008;
      add_run(coverage, scenario, seed);
    }
    fmt::print("kart with a wrong latency: {} of {} poses beyond 5 sigma, sigma / error {:.2f}\n",
               coverage.beyond_position, coverage.poses, coverage.std_over_rms());
    THEN("the error exceeds five standard deviations in less than 1 % of the poses") {
      check_covered(coverage);
    }
  }
}

}  // namespace kalman_slow_error_test
