/// Randomly drawn motions match their scenarios' descriptions.

#include "sim/simulator.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace harder_motions_test {

using namespace sonopose;
using namespace sonopose::sim;

constexpr double step_s = 2e-3;
constexpr int runs = 8;
constexpr double per_deg = geometry::radians_per_degree;

Scenario drawn_of(const char* name, int seed) {
  return drawn(find_scenario(name), {.seed = static_cast<std::uint64_t>(seed)});
}

double speed_mps(const Motion& motion) {
  return motion.velocity_world_mps.norm();
}

double tilt_rad(const Motion& motion) {
  return std::acos(std::min(1.0, (motion.q_body_to_world * Vector3d::UnitZ()).z()));
}

/// Yaw relative to the direction of travel.
double course_rad(const Motion& motion) {
  const Vector3d& v = motion.velocity_world_mps;
  return geometry::wrap_angle(geometry::yaw_of(motion.q_body_to_world) - std::atan2(v.y(), v.x()));
}

/// Counts the body's stops.
int stops_of(const Scenario& scenario) {
  int stops = 0;
  bool moved = false;
  for (double t = 0; t < scenario.duration_s; t += step_s) {
    const double speed = speed_mps(scenario.motion(t));
    if (speed < 1e-6 && moved) ++stops;
    if (speed < 1e-6) moved = false;
    if (speed > 0.5) moved = true;
  }
  return stops;
}

SCENARIO("the harder motions rest at first, level, except the one that does not") {
  for (const Scenario& scenario : harder_scenarios()) {
    if (scenario.name == "moving_start") continue;
    CAPTURE(scenario.name);
    const Scenario run = drawn(scenario, {.seed = 5});
    for (double t = 0; t <= 3.0; t += 0.05) {
      const Motion motion = run.motion(t);
      CHECK(speed_mps(motion) == 0.0);
      CHECK(motion.acceleration_world_mps2.norm() == 0.0);
      CHECK(motion.angular_velocity_body_radps.norm() == 0.0);
      CHECK(tilt_rad(motion) == 0.0);
    }
  }
}

SCENARIO("the harder motions continue without end") {
  for (const Scenario& scenario : harder_scenarios()) {
    CAPTURE(scenario.name);
    const Motion late = drawn(scenario, {.seed = 5}).motion(3600.0);
    CHECK(late.position_world_m.norm() < 50.0);
    CHECK(speed_mps(late) < 7.0);
  }
}

SCENARIO("the truck with hard stops stops hard") {
  for (int seed = 1; seed <= runs; ++seed) {
    const Scenario run = drawn_of("hard_stops", seed);
    double max_mps = 0;
    double forward_mps2 = 0;
    double braking_mps2 = 0;
    for (double t = 0; t < run.duration_s; t += step_s) {
      const Motion motion = run.motion(t);
      const Vector3d accel_body_mps2 = motion.q_body_to_world.conjugate() * motion.acceleration_world_mps2;
      max_mps = std::max(max_mps, speed_mps(motion));
      forward_mps2 = std::max(forward_mps2, accel_body_mps2.x());
      braking_mps2 = std::max(braking_mps2, -accel_body_mps2.x());
    }
    CAPTURE(seed);
    CHECK(max_mps > 1.5);
    CHECK(max_mps <= 2.5);
    for (const double reached_mps2 : {forward_mps2, braking_mps2}) {
      CHECK(reached_mps2 > 15.0);
      CHECK(reached_mps2 <= 20.0 + 1e-9);
    }
    CHECK(stops_of(run) >= 8);
  }
}

SCENARIO("the hall run takes its corners at speed and pauses") {
  int corners = 0;
  int stops = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const Scenario run = drawn_of("hall", seed);
    bool turned_before = false;
    for (double t = 0; t < run.duration_s; t += step_s) {
      const Motion motion = run.motion(t);
      REQUIRE(speed_mps(motion) <= 3.0 + 1e-9);
      if (speed_mps(motion) > 0.1) REQUIRE(std::abs(course_rad(motion)) < 1e-6);
      const bool turns = std::abs(motion.angular_velocity_body_radps.z()) > 0.5 && speed_mps(motion) > 1.0;
      if (turns && !turned_before) ++corners;
      if (turns) REQUIRE(speed_mps(motion) > 1.3);
      turned_before = turns;
    }
    stops += stops_of(run);
  }
  THEN("there are more corners than stops, and stops in every run") {
    CHECK(corners > runs * 5);
    CHECK(stops > runs * 2);
    CHECK(corners > stops);
  }
}

SCENARIO("a device in the hand tilts by up to 60 degrees and stays within the gyro's range") {
  double max_tilt_rad = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const Scenario run = drawn_of("hand_held", seed);
    double tilt_of_run_rad = 0;
    double shaking_mps2 = 0;
    for (double t = 0; t < run.duration_s; t += step_s) {
      const Motion motion = run.motion(t);
      tilt_of_run_rad = std::max(tilt_of_run_rad, tilt_rad(motion));
      shaking_mps2 = std::max(shaking_mps2, motion.acceleration_world_mps2.norm());
      REQUIRE(motion.angular_velocity_body_radps.norm() < 10.0);
    }
    CAPTURE(seed);
    CHECK(tilt_of_run_rad > 20.0 * per_deg);
    CHECK(tilt_of_run_rad <= 60.0 * per_deg);
    CHECK(shaking_mps2 > 3.0);
    max_tilt_rad = std::max(max_tilt_rad, tilt_of_run_rad);
  }
  CHECK(max_tilt_rad > 50.0 * per_deg);
}

SCENARIO("a moving start is already on its way, in any direction") {
  std::set<int> directions;
  std::set<int> courses;
  double min_mps = 1e9;
  double max_mps = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Run run{.seed = seed};
    const Motion start = Simulator(find_scenario("moving_start"), run).motion_at(run.start_time_ns);
    CHECK(speed_mps(start) >= 1.0);
    CHECK(speed_mps(start) <= 6.0);
    min_mps = std::min(min_mps, speed_mps(start));
    max_mps = std::max(max_mps, speed_mps(start));
    const Vector3d& v = start.velocity_world_mps;
    directions.insert(static_cast<int>(std::floor(std::atan2(v.y(), v.x()) / (M_PI / 4))));
    courses.insert(static_cast<int>(std::floor(course_rad(start) / (M_PI / 4))));
  }
  CHECK(min_mps < 1.2);
  CHECK(max_mps > 5.5);
  CHECK(directions.size() == 8);
  CHECK(courses.size() == 8);
}

}  // namespace harder_motions_test
