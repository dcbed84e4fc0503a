/// Covariance of the published pose against the errors of simulated runs.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/seeds.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/ros2/messages/covariance.hpp>
#include <sonopose/ros2/messages/frames.hpp>

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <string>

namespace covariance_consistency_test {

using namespace sonopose;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Error of the base's pose: position, and small rotation about the map's axes.
Vector6d error_of(const FusedPose& pose, const TruthSample& truth, const ros2::Mount& mount) {
  FusedPose true_pose;
  true_pose.position_world_m = truth.position_world_m;
  true_pose.q_body_to_world = truth.q_body_to_world;
  const ros2::BaseState fused = ros2::base_state(pose, mount);
  const ros2::BaseState actual = ros2::base_state(true_pose, mount);
  const Eigen::AngleAxisd turn(fused.q_base_to_map * actual.q_base_to_map.conjugate());
  Vector6d error;
  error << fused.position_map_m - actual.position_map_m, turn.angle() * turn.axis();
  return error;
}

/// Sums over all runs of the squared normalised errors of pose, position and yaw.
struct Sums {
  double pose = 0;
  double position = 0;
  double yaw = 0;
  int count = 0;
};

void add_run(Sums& sums, const sim::Scenario& scenario, std::uint64_t seed,
             const settings::Settings& settings) {
  constexpr double settled_s = 10.0;
  constexpr int decimation = 25;  // neighbouring poses have the same error
  const ros2::Mount mount{{0.2, -0.1, 0.3}, Quaterniond::Identity()};
  sim::Simulator simulator(scenario, scenario.sensors, {.seed = seed, .duration_s = 30.0});
  estimation::AnyEstimator engine(settings);
  TimeNs begin_ns = 0;
  int poses = 0;
  while (auto step = simulator.next()) {
    const auto result = estimation::process(engine, step->event);
    const auto* pose = std::get_if<FusedPose>(&result);
    if (pose == nullptr) continue;
    if (begin_ns == 0) begin_ns = pose->time_ns;
    if (seconds_between(begin_ns, pose->time_ns) < settled_s || ++poses % decimation != 0) continue;
    const Eigen::Matrix<double, 6, 6> covariance = ros2::pose_covariance(*pose, mount, {});
    const Vector6d error = error_of(*pose, *step->truth, mount);
    sums.pose += error.dot(covariance.llt().solve(error));
    const Eigen::Matrix3d of_position = covariance.topLeftCorner<3, 3>();
    sums.position += error.head<3>().dot(of_position.llt().solve(error.head<3>()));
    sums.yaw += error[5] * error[5] / covariance(5, 5);
    ++sums.count;
  }
}

SCENARIO("the covariance of the published pose matches its errors", "[accuracy]") {
  GIVEN("runs of ordinary motion with seeds that nothing was tuned on") {
    const std::string engine = GENERATE("kalman", "documented");
    const std::string name = GENERATE("walk", "forklift", "kart", "drone", "no_heading");
    settings::Settings settings;
    if (engine == "documented") settings.engine.engine = settings::EngineKind::documented;
    Sums sums;
    const std::uint64_t first = 4001;
    for (std::uint64_t seed = first; seed < first + test::seeds(4, 20); ++seed) {
      add_run(sums, sim::find_scenario(name), seed, settings);
    }
    const double pose = sums.pose / sums.count / 6;
    fmt::print("{} {}: pose {:.2f}, position {:.2f}, yaw {:.2f} per degree of freedom\n", name, engine, pose,
               sums.position / sums.count / 3, sums.yaw / sums.count);
    THEN("the squared normalised error is that of its dimension, or smaller for the cautious engine") {
      CHECK(pose > (engine == "documented" ? 0.05 : 0.5));
      CHECK(pose < 2.0);
    }
  }
}

}  // namespace covariance_consistency_test
