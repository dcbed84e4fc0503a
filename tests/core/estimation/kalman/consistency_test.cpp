/// The Kalman engine's standard deviations against its errors, over many simulated runs.

#include "evaluation/score/score.hpp"
#include "recording/log_folder.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/recordings.hpp"
#include "support/seeds.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string>

namespace consistency_test {

using namespace sonopose;

/// Mean squared normalised error per degree of freedom: 1 if the covariance is right.
struct NormalisedMean {
  double sum = 0;
  int count = 0;

  void add(double squared_norm, int degrees) {
    sum += squared_norm / degrees;
    ++count;
  }
  [[nodiscard]] double value() const { return sum / count; }
};

struct Consistency {
  NormalisedMean position;
  NormalisedMean velocity;
  NormalisedMean yaw;
  NormalisedMean attitude;
  NormalisedMean pose;  ///< position and attitude jointly
  NormalisedMean innovation;
  /// Number of innovations above the χ² quantiles (3 degrees of freedom) for 5, 1 and 0.1 %.
  std::array<int, 3> above{};

  [[nodiscard]] double share_above(std::size_t which) const {
    return static_cast<double>(above[which]) / innovation.count;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format(
        "position {:.2f}, velocity {:.2f}, yaw {:.2f}; innovations {:.3f}, above 5 / 1 / 0.1 %: {:.2f} / "
        "{:.2f} / {:.3f} %",
        position.value(), velocity.value(), yaw.value(), innovation.value(), 100.0 * share_above(0),
        100.0 * share_above(1), 100.0 * share_above(2));
  }
};

/// Squared error over its covariance, of any size: a decomposition for each would take seconds to compile.
double squared_norm(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& error) {
  return error.dot(covariance.llt().solve(error));
}

/// Rotation about the fixed world axes from `from` to `to`.
Vector3d rotation_world_rad(const Quaterniond& from, const Quaterniond& to) {
  const Eigen::AngleAxisd rotation(to * from.conjugate());
  return rotation.angle() * rotation.axis();
}

void add(Consistency& consistency, const FusedPose& pose, const TruthSample& truth) {
  const auto pose_covariance = pose.pose_covariance.matrix();
  consistency.position.add(
      squared_norm(pose_covariance.topLeftCorner<3, 3>(), pose.position_world_m - truth.position_world_m), 3);
  consistency.velocity.add(
      squared_norm(pose.velocity_covariance.matrix(), pose.velocity_world_mps - truth.velocity_world_mps), 3);
  const double yaw_error_rad =
      geometry::wrap_angle(geometry::yaw_of(pose.q_body_to_world) - geometry::yaw_of(truth.q_body_to_world));
  consistency.yaw.add(yaw_error_rad * yaw_error_rad / pose_covariance(5, 5), 1);
  Eigen::Matrix<double, 6, 1> error;
  error << truth.position_world_m - pose.position_world_m,
      rotation_world_rad(pose.q_body_to_world, truth.q_body_to_world);
  consistency.attitude.add(squared_norm(pose_covariance.bottomRightCorner<3, 3>(), error.tail<3>()), 3);
  consistency.pose.add(squared_norm(pose_covariance, error), 6);
}

void add(Consistency& consistency, const FixReport& report) {
  constexpr std::array quantiles{7.815, 11.345, 16.266};
  if (!report.innovation_covariance_m2) return;
  const double norm = squared_norm(report.innovation_covariance_m2->matrix(), report.innovation_world_m);
  consistency.innovation.add(norm, 3);
  for (std::size_t i = 0; i < quantiles.size(); ++i) consistency.above[i] += norm > quantiles[i] ? 1 : 0;
}

/// Adds a run whose fixes state their noise if `known_noise`; otherwise the engine learns it.
void add_run(Consistency& consistency, const sim::Scenario& scenario, std::uint64_t seed, bool known_noise) {
  constexpr double settled_s = 10.0;
  constexpr int decimation = 25;  // neighbouring poses have the same error
  sim::SensorSettings sensors = scenario.sensors;
  sim::Random draw(seed);
  const double noise_m = draw.uniform_in(sensors.fix_noise_m);
  sensors.fix_noise_m = noise_m;
  sim::Simulator simulator(scenario, sensors, {.seed = seed, .duration_s = 30.0});
  estimation::kalman::Engine engine{settings::Settings{}};
  TimeNs begin_ns = 0;
  int poses = 0;
  while (auto step = simulator.next()) {
    if (auto* fix = std::get_if<UltrasonicFix>(&step->event); fix != nullptr && known_noise) {
      fix->covariance_world_m2 = Covariance<3>::from_matrix(noise_m * noise_m * Eigen::Matrix3d::Identity());
    }
    const auto result = estimation::process(engine, step->event);
    if (const auto* pose = std::get_if<FusedPose>(&result)) {
      if (begin_ns == 0) begin_ns = pose->time_ns;
      if (seconds_between(begin_ns, pose->time_ns) < settled_s || ++poses % decimation != 0) continue;
      add(consistency, *pose, *step->truth);
    } else if (const auto* report = std::get_if<FixReport>(&result)) {
      if (seconds_between(begin_ns, report->emission_time_ns) >= settled_s) add(consistency, *report);
    }
  }
}

SCENARIO("the Kalman engine knows how uncertain it is", "[accuracy]") {
  const unsigned runs = test::seeds(20, 100);
  GIVEN("runs of ordinary motion that nothing was tuned on") {
    const std::string name = GENERATE("walk", "forklift", "kart", "drone");
    const bool known_noise = GENERATE(false, true);
    Consistency consistency;
    for (std::uint64_t seed = 2001; seed < 2001 + runs; ++seed) {
      add_run(consistency, sim::find_scenario(name), seed, known_noise);
    }
    fmt::print("{}, fix noise {}: {}\n", name, known_noise ? "known" : "learned", consistency.text());
    THEN("its errors are as large as their standard deviations say, within 30 % of the variance") {
      for (const auto& mean : {consistency.position, consistency.velocity, consistency.yaw}) {
        CHECK(mean.value() > 0.7);
        CHECK(mean.value() < 1.3);
      }
      AND_THEN("so are its innovations, and outliers are as rare as in a normal distribution") {
        CHECK(consistency.innovation.value() == Approx(1.0).margin(0.06));
        constexpr std::array expected{0.05, 0.01, 0.001};
        const std::size_t shares = runs < 100 ? 2 : 3;  // with few runs, chance may halve the rarest
        for (std::size_t i = 0; i < shares; ++i) {
          CAPTURE(expected[i]);
          CHECK(consistency.share_above(i) < 2.0 * expected[i]);
          CHECK(consistency.share_above(i) > 0.5 * expected[i]);
        }
      }
    }
  }
}

SCENARIO("the velocity's covariance is that of the tracked point") {
  GIVEN("20 runs of a beacon that turns by 9 rad/s with its IMU off the axis") {
    Consistency consistency;
    for (std::uint64_t seed = 2001; seed <= 2020; ++seed) {
      add_run(consistency, sim::find_scenario("spin"), seed, false);
    }
    fmt::print("spin: {}\n", consistency.text());
    THEN("the velocity's errors are as large as their standard deviations say") {
      CHECK(consistency.velocity.value() > 0.7);
      CHECK(consistency.velocity.value() < 1.3);
    }
  }
}

SCENARIO("the pose's covariance is that of position and a rotation about the world's axes") {
  GIVEN("20 runs of a beacon that is tilted by up to 60 degrees, so that yaw is about no axis of the body") {
    Consistency consistency;
    for (std::uint64_t seed = 2001; seed <= 2020; ++seed) {
      add_run(consistency, sim::find_scenario("hand_held"), seed, false);
    }
    fmt::print("hand_held: attitude {:.2f}, pose {:.2f}\n", consistency.attitude.value(),
               consistency.pose.value());
    THEN("the errors of the attitude, and of the whole pose, are as large as it says") {
      for (const auto& mean : {consistency.attitude, consistency.pose}) {
        CHECK(mean.value() > 0.7);
        CHECK(mean.value() < 1.3);
      }
    }
  }
}

SCENARIO("the Kalman engine knows how uncertain it is on real flights") {
  const std::string name = GENERATE("drone_a", "drone_b");
  const std::filesystem::path folder = test::beacon_recordings(name);
  if (!test::is_here(folder)) return;
  GIVEN("a flight with motion capture") {
    const recording::SensorLog log = recording::read_sensor_log(folder);
    evaluation::TruthTrack truth(log.truth);
    estimation::kalman::Engine engine{settings::Settings{}};
    NormalisedMean position;
    TimeNs begin_ns = 0;
    for (const Event& event : log.events) {
      const auto result = estimation::process(engine, event);
      const auto* pose = std::get_if<FusedPose>(&result);
      if (pose == nullptr) continue;
      if (begin_ns == 0) begin_ns = pose->time_ns;
      const auto true_pose = truth.at(pose->time_ns);
      if (!true_pose || !true_pose->position_world_m.allFinite() ||
          seconds_between(begin_ns, pose->time_ns) < 10.0)
        continue;
      position.add(squared_norm(pose->pose_covariance.matrix().topLeftCorner<3, 3>(),
                                pose->position_world_m - true_pose->position_world_m),
                   3);
    }
    fmt::print("{}: position {:.2f}\n", name, position.value());
    THEN("its errors are as large as its standard deviations say, within a factor of √2") {
      CHECK(position.value() > 0.5);
      CHECK(position.value() < 2.0);
    }
  }
}

}  // namespace consistency_test
