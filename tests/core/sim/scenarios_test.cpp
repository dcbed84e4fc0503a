/// Each scenario's motion matches its name.

#include "sim/simulator.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace scenarios_test {

using namespace sonopose;
using namespace sonopose::sim;

constexpr double gravity_mps2 = 9.80665;

/// Extremes of a motion during its scenario, sampled every millisecond.
struct Extremes {
  double speed_mps = 0;
  double min_cruise_mps = 1e9;  ///< lowest speed after the first 9 s
  double acceleration_mps2 = 0;
  double left_mps2 = 0;  ///< body-frame acceleration
  double right_mps2 = 0;
  double forward_mps2 = 0;
  double braking_mps2 = 0;
  double left_turn_radps = 0;
  double right_turn_radps = 0;
  double tilt_rad = 0;
  double lowest_m = 1e9;
  double highest_m = -1e9;
};

Extremes extremes_of(const Scenario& scenario) {
  Extremes reached;
  const auto most = [](double& value, double candidate) { value = std::max(value, candidate); };
  for (double t = 0; t < scenario.duration_s; t += 1e-3) {
    const Motion motion = scenario.motion(t);
    const Vector3d accel_body_mps2 = motion.q_body_to_world.conjugate() * motion.acceleration_world_mps2;
    const double speed_mps = motion.velocity_world_mps.norm();
    most(reached.speed_mps, speed_mps);
    if (t > 9.0) reached.min_cruise_mps = std::min(reached.min_cruise_mps, speed_mps);
    most(reached.acceleration_mps2, motion.acceleration_world_mps2.norm());
    most(reached.left_mps2, accel_body_mps2.y());
    most(reached.right_mps2, -accel_body_mps2.y());
    most(reached.forward_mps2, accel_body_mps2.x());
    most(reached.braking_mps2, -accel_body_mps2.x());
    most(reached.left_turn_radps, motion.angular_velocity_body_radps.z());
    most(reached.right_turn_radps, -motion.angular_velocity_body_radps.z());
    most(reached.tilt_rad, std::acos(std::min(1.0, (motion.q_body_to_world * Vector3d::UnitZ()).z())));
    reached.lowest_m = std::min(reached.lowest_m, motion.position_world_m.z());
    reached.highest_m = std::max(reached.highest_m, motion.position_world_m.z());
  }
  return reached;
}

SCENARIO("the names of the scenarios are unique") {
  std::set<std::string> names;
  for (const auto& group : {scenarios(), harder_scenarios(), violations()}) {
    for (const Scenario& scenario : group) {
      CHECK(names.insert(std::string(scenario.name)).second);
      CHECK_FALSE(scenario.summary.empty());
      CHECK(scenario.score_after_s >= 6.0);
      CHECK(scenario.duration_s >= scenario.score_after_s + 30.0);
      CHECK(&find_scenario(scenario.name) == &scenario);
    }
  }
  for (const char* name : {"rest", "walk", "forklift", "kart", "spin", "drone", "outlier_bursts", "outages",
                           "low_quality", "relocation", "no_heading", "gyro_bias", "jitter", "packet_loss"}) {
    CHECK(names.count(name) == 1);
  }
}

SCENARIO("every scenario rests for the first three seconds, level, so that gyros can be calibrated") {
  for (const Scenario& scenario : scenarios()) {
    GIVEN("the scenario " + std::string(scenario.name)) {
      const Motion first = scenario.motion(0.0);
      THEN("it is at rest and level until then") {
        for (double t = 0; t <= 3.0; t += 0.05) {
          const Motion motion = scenario.motion(t);
          CHECK(motion.position_world_m == first.position_world_m);
          CHECK(motion.velocity_world_mps.norm() == 0.0);
          CHECK(motion.acceleration_world_mps2.norm() == 0.0);
          CHECK(motion.angular_velocity_body_radps.norm() == 0.0);
          CHECK((motion.q_body_to_world * Vector3d::UnitZ()).z() == Approx(1.0));
        }
      }
    }
  }
}

SCENARIO("the forklift stops, goes and turns on the spot") {
  const Scenario& forklift = find_scenario("forklift");
  const Extremes reached = extremes_of(forklift);
  THEN("it reaches 2 m/s, and neither speeds up nor brakes harder than 2 m/s²") {
    CHECK(reached.speed_mps == Approx(2.0).epsilon(0.01));
    CHECK(reached.forward_mps2 > 1.5);
    CHECK(reached.acceleration_mps2 < 2.0);
    CHECK(reached.left_turn_radps > 1.5);
    CHECK(reached.right_turn_radps > 1.5);
  }
  THEN("while it turns fast it hardly moves, and while it drives it does not turn") {
    double turning_speed_mps = 0;
    double driving_turn_radps = 0;
    for (double t = 0; t < 60.0; t += 1e-3) {
      const Motion motion = forklift.motion(t);
      const double turn_radps = std::abs(motion.angular_velocity_body_radps.z());
      if (turn_radps > 1.0) turning_speed_mps = std::max(turning_speed_mps, motion.velocity_world_mps.norm());
      if (motion.velocity_world_mps.norm() > 0.5)
        driving_turn_radps = std::max(driving_turn_radps, turn_radps);
    }
    CHECK(turning_speed_mps < 0.4);
    CHECK(driving_turn_radps == 0.0);
  }
  THEN("it stands six times a lap or more, for up to two seconds") {
    int stops = 0;
    double standing_s = 0;
    double longest_s = 0;
    for (double t = 4.0; t < 53.0; t += 1e-3) {
      const Motion motion = forklift.motion(t);
      const bool stands =
          motion.velocity_world_mps.norm() < 1e-3 && motion.angular_velocity_body_radps.norm() < 1e-3;
      if (stands && standing_s == 0) ++stops;
      standing_s = stands ? standing_s + 1e-3 : 0.0;
      longest_s = std::max(longest_s, standing_s);
    }
    CHECK(stops >= 6);
    CHECK(longest_s > 1.9);
    CHECK(longest_s < 2.5);
  }
}

SCENARIO("the kart drives at 6 m/s through curves both ways") {
  const Extremes reached = extremes_of(find_scenario("kart"));
  CHECK(reached.speed_mps == Approx(6.0).margin(0.3));
  CHECK(reached.min_cruise_mps > 4.0);
  for (const double lateral_mps2 : {reached.left_mps2, reached.right_mps2}) {
    CHECK(lateral_mps2 > 5.0);
    CHECK(lateral_mps2 < 6.5);
  }
  CHECK(reached.forward_mps2 > 1.0);
  CHECK(reached.braking_mps2 > 1.0);
  CHECK(reached.tilt_rad > 1.0 * geometry::radians_per_degree);
  CHECK(reached.tilt_rad < 2.5 * geometry::radians_per_degree);
}

SCENARIO("the spin turns on the spot, and its IMU feels what the tracked point does not") {
  const Scenario& spin = find_scenario("spin");
  GIVEN("its motion") {
    const Extremes reached = extremes_of(spin);
    THEN("it turns both ways at 9 rad/s, below the gyro's limit, and drives at 1 m/s in between") {
      CHECK(reached.left_turn_radps == Approx(9.0));
      CHECK(reached.right_turn_radps == Approx(9.0));
      CHECK(reached.speed_mps == Approx(1.0));
      for (double t = 0; t < 60.0; t += 1e-3) {
        const Motion motion = spin.motion(t);
        if (motion.angular_velocity_body_radps.norm() > 1e-9)
          REQUIRE(motion.velocity_world_mps.norm() < 1e-9);
      }
    }
  }
  GIVEN("the scenario's IMU without its noise") {
    SensorSettings sensors = SensorSettings::ideal();
    sensors.imu_from_tracked_point_body_m = spin.sensors.imu_from_tracked_point_body_m;
    CHECK(sensors.imu_from_tracked_point_body_m.norm() == Approx(0.06));
    Simulator simulator(spin, sensors, {.duration_s = 60.0});
    int at_full_rate = 0;
    double greatest_mps2 = 0;
    while (const auto step = simulator.next()) {
      const auto* imu = std::get_if<ImuSample>(&step->event);
      if (imu == nullptr) continue;
      const Vector3d horizontal_mps2 = imu->specific_force_body_mps2 - Vector3d(0, 0, gravity_mps2);
      const double rate_radps = imu->angular_velocity_body_radps.z();
      greatest_mps2 = std::max(greatest_mps2, horizontal_mps2.norm());
      if (std::abs(rate_radps) < 8.9999) continue;
      ++at_full_rate;
      // Centripetal acceleration ω² r = 81 · 0.06, towards the axis.
      REQUIRE((horizontal_mps2 - Vector3d(-4.86, 0, 0)).norm() < 0.01);
    }
    THEN("at full rate it reads gravity and ω² r, and that is the most it ever reads") {
      CHECK(at_full_rate > 1000);
      CHECK(greatest_mps2 == Approx(4.86).margin(0.01));
    }
  }
}

SCENARIO("the drone flies by its thrust alone") {
  const Scenario& drone = find_scenario("drone");
  GIVEN("its motion") {
    double off_the_thrust_mps2 = 0;
    for (double t = 0; t < 60.0; t += 0.01) {
      const ImuSample imu = ideal_imu_sample(drone.motion(t));
      off_the_thrust_mps2 = std::max(off_the_thrust_mps2, imu.specific_force_body_mps2.head<2>().norm());
    }
    THEN("its accelerometer reads along body Z alone: the rotors can push nowhere else") {
      CHECK(off_the_thrust_mps2 < 1e-12);
    }
    THEN("it reaches about 2 m/s, leans, climbs and sinks by more than a metre, and turns slowly") {
      const Extremes reached = extremes_of(drone);
      CHECK(reached.speed_mps == Approx(2.0).margin(0.2));
      CHECK(reached.tilt_rad > 8.0 * geometry::radians_per_degree);
      CHECK(reached.tilt_rad < 20.0 * geometry::radians_per_degree);
      CHECK(reached.highest_m - reached.lowest_m > 1.5);
      CHECK(reached.lowest_m > 0.0);
      CHECK(reached.left_turn_radps > 0.1);
      CHECK(reached.left_turn_radps < 0.5);
    }
  }
}

SCENARIO("driven and walked paths are periodic") {
  GIVEN("an hour later") {
    THEN("no path has run away") {
      for (const Scenario& scenario : scenarios()) {
        const Motion late = scenario.motion(3600.0);
        CAPTURE(scenario.name);
        CHECK(late.position_world_m.norm() < 40.0);
        CHECK(late.velocity_world_mps.norm() < 7.0);
      }
    }
  }
  GIVEN("the joints of the laps") {
    THEN("nothing jumps there") {
      for (const char* name : {"forklift", "spin"}) {
        const Scenario& scenario = find_scenario(name);
        for (double t = 3.0; t < 130.0; t += 1e-3) {
          const Motion before = scenario.motion(t);
          const Motion after = scenario.motion(t + 1e-3);
          REQUIRE((after.position_world_m - before.position_world_m).norm() < 2.1e-3);
          REQUIRE(before.q_body_to_world.angularDistance(after.q_body_to_world) < 9.1e-3);
        }
      }
    }
  }
}

SCENARIO("turning the world does not change the IMU samples") {
  GIVEN("the drone in flight, and the world turned by 2 rad about a point") {
    const Motion motion = find_scenario("drone").motion(20.0);
    const Vector3d pivot(1.0, -2.0, 0.5);
    const Motion other = turned(motion, pivot, 2.0);
    THEN("its IMU reads the same, it looks elsewhere, and is as far from the point") {
      const ImuSample before = ideal_imu_sample(motion, {0.06, 0.0, 0.01});
      const ImuSample after = ideal_imu_sample(other, {0.06, 0.0, 0.01});
      CHECK((before.specific_force_body_mps2 - after.specific_force_body_mps2).norm() < 1e-12);
      CHECK(before.angular_velocity_body_radps == after.angular_velocity_body_radps);
      const double yaw_change =
          geometry::yaw_of(other.q_body_to_world) - geometry::yaw_of(motion.q_body_to_world);
      CHECK(std::abs(geometry::wrap_angle(yaw_change - 2.0)) < 1e-12);
      const Vector3d arm = motion.position_world_m - pivot;
      const Vector3d turned_arm = other.position_world_m - pivot;
      CHECK(turned_arm.z() == Approx(arm.z()));
      CHECK(turned_arm.x() == Approx(std::cos(2.0) * arm.x() - std::sin(2.0) * arm.y()));
      CHECK(turned_arm.y() == Approx(std::sin(2.0) * arm.x() + std::cos(2.0) * arm.y()));
      CHECK(other.velocity_world_mps.x() == Approx(std::cos(2.0) * motion.velocity_world_mps.x() -
                                                   std::sin(2.0) * motion.velocity_world_mps.y()));
    }
  }
}

}  // namespace scenarios_test
