/// Difference between a fusion that starts late and one that runs from the start, on the same events.

#include "fusion/estimators_feeder.hpp"
#include "fusion/standby.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <string>

namespace late_starter_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::fusion::test;

struct Difference {
  double position_m = 0;
  double velocity_mps = 0;
  double angle_rad = 0;
};

/// Largest differences from the time at which the late fusion would claim the beacon.
Difference difference_after_warm_up(double late_by_s, const std::string& engine) {
  config::FusionConfig config;
  config.assign("fusion.engine=" + engine);
  const auto events = walk(7, late_by_s + 30.0);
  const TimeNs start_ns = available_at_ns(events.front()) + to_ns(late_by_s);
  Feeder early(false, config);
  Feeder late(false, config);
  for (const Event& event : events) {
    early.push(event);
    if (available_at_ns(event) >= start_ns) late.push(event);
  }
  std::map<TimeNs, FusedPose> of_early;
  for (const FusedPose& pose : early.poses) of_early[pose.time_ns] = pose;
  Standby standby({}, 100'000'000);
  Difference most;
  for (const FusedPose& pose : late.poses) {
    if (standby.on_pose(7, pose.status, 0, SteadyTime{pose.time_ns}).role != FusionRole::serving) continue;
    const FusedPose& other = of_early.at(pose.time_ns);
    most.position_m = std::max(most.position_m, (pose.position_world_m - other.position_world_m).norm());
    most.velocity_mps =
        std::max(most.velocity_mps, (pose.velocity_world_mps - other.velocity_world_mps).norm());
    most.angle_rad = std::max(most.angle_rad, pose.q_body_to_world.angularDistance(other.q_body_to_world));
  }
  REQUIRE(most.position_m > 0.0);  // it did claim, and is a separate engine
  return most;
}

SCENARIO("a fusion that starts late agrees with the others when it claims a beacon") {
  struct Case {
    std::string engine;
    Difference limit;
  };
  const auto [engine, limit] = GENERATE(Case{"documented", {0.025, 0.07, 0.4 * geometry::radians_per_degree}},
                                        // The late engine is still learning its biases when it claims.
                                        Case{"kalman", {0.04, 0.12, 1.3 * geometry::radians_per_degree}});
  for (const double late_by_s : {5.0, 12.3, 20.0}) {
    const Difference most = difference_after_warm_up(late_by_s, engine);
    INFO(engine << ", " << late_by_s << " s late");
    INFO(most.position_m << " m, " << most.velocity_mps << " m/s, " << most.angle_rad << " rad");
    CHECK(most.position_m < limit.position_m);
    CHECK(most.velocity_mps < limit.velocity_mps);
    CHECK(most.angle_rad < limit.angle_rad);
  }
}

}  // namespace late_starter_test
