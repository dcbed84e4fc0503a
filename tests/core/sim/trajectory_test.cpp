#include "sim/simulator.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace trajectory_test {

using namespace sonopose;
using namespace sonopose::sim;

/// Mean body rate from one attitude to the other over `span_s`.
Vector3d rate_between(const Quaterniond& before, const Quaterniond& after, double span_s) {
  const Eigen::AngleAxisd turn(before.conjugate() * after);
  const double angle = geometry::wrap_angle(turn.angle());
  return angle / span_s * turn.axis();
}

/// A motion and the bounds of the third derivatives of its position (m/s³) and attitude (rad/s³).
struct Case {
  Scenario scenario;
  std::uint64_t seed;
  double jerk_limit;
  double angular_jerk_limit;
};

std::vector<Case> cases() {
  std::vector<Case> found;
  // Bobbing by 1 cm at 1.8 Hz: 14 m/s³. A step of the acceleration would yield thousands.
  for (const Scenario& scenario : scenarios()) found.push_back({scenario, 0, 60.0, 60.0});
  for (const Scenario& scenario : harder_scenarios()) {
    const std::string_view name = scenario.name;
    // A stop from 2.5 m/s with 20 m/s² has 5.77 · 2.5 m/s / (0.234 s)². Shaking at 6 Hz multiplies 1 cm and
    // 2° by 53,600 s⁻³ per axis.
    const double jerk_limit = name == "hard_stops" ? 500.0 : name == "hand_held" ? 1000.0 : 60.0;
    const double angular_jerk_limit = name == "hand_held" ? 5000.0 : 120.0;
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      found.push_back({drawn(scenario, {.seed = seed}), seed, jerk_limit, angular_jerk_limit});
    }
  }
  return found;
}

SCENARIO("the derivatives of each motion are consistent") {
  for (const auto& [scenario, seed, jerk_limit, angular_jerk_limit] : cases()) {
    GIVEN("the scenario " + std::string(scenario.name) + ", seed " + std::to_string(seed)) {
      WHEN("finite differences are taken every few hundredths of a second") {
        constexpr double h = 1e-4;
        double velocity_error = 0;
        double acceleration_error = 0;
        double rate_error = 0;
        double rate_change_error = 0;
        for (int i = 0; i < 800; ++i) {
          const double t = 0.5 + 0.0371 * i;
          const Motion now = scenario.motion(t);
          const Motion before = scenario.motion(t - h);
          const Motion after = scenario.motion(t + h);
          const auto worst = [](double& error, const Vector3d& difference) {
            error = std::max(error, difference.norm());
          };
          worst(velocity_error,
                (after.position_world_m - before.position_world_m) / (2 * h) - now.velocity_world_mps);
          worst(acceleration_error, (after.velocity_world_mps - before.velocity_world_mps) / (2 * h) -
                                        now.acceleration_world_mps2);
          worst(rate_error, rate_between(before.q_body_to_world, after.q_body_to_world, 2 * h) -
                                now.angular_velocity_body_radps);
          worst(rate_change_error,
                (after.angular_velocity_body_radps - before.angular_velocity_body_radps) / (2 * h) -
                    now.angular_acceleration_body_radps2);
        }
        THEN("they agree up to the differences' own error") {
          // At the joint of two path segments the third derivative may step by less than its limit (next
          // test).
          constexpr double at_a_joint = h / 4.0;
          constexpr double of_the_rate = h * h / 6.0;
          CHECK(velocity_error < std::max(1e-6, of_the_rate * jerk_limit));
          CHECK(acceleration_error < at_a_joint * jerk_limit);
          CHECK(rate_error < std::max(1e-6, of_the_rate * angular_jerk_limit));
          CHECK(rate_change_error < at_a_joint * angular_jerk_limit);
        }
      }
    }
  }
}

SCENARIO("no motion has a step in its acceleration") {
  for (const auto& [scenario, seed, jerk_limit, angular_jerk_limit] : cases()) {
    GIVEN("the scenario " + std::string(scenario.name) + ", seed " + std::to_string(seed)) {
      constexpr double step_s = 1e-3;
      double jerk = 0;
      double angular_jerk = 0;
      for (int i = 0; i < 20'000; ++i) {
        const double t = step_s * i;
        const Motion now = scenario.motion(t);
        const Motion next = scenario.motion(t + step_s);
        jerk = std::max(jerk, (next.acceleration_world_mps2 - now.acceleration_world_mps2).norm() / step_s);
        angular_jerk = std::max(
            angular_jerk,
            (next.angular_acceleration_body_radps2 - now.angular_acceleration_body_radps2).norm() / step_s);
      }
      THEN("no third derivative exceeds that of the motion") {
        CHECK(jerk < jerk_limit);
        CHECK(angular_jerk < angular_jerk_limit);
      }
    }
  }
}

SCENARIO("the walk is a walk") {
  const Scenario& walk = find_scenario("walk");
  GIVEN("its first three seconds") {
    THEN("it stands still") {
      for (int i = 0; i <= 30; ++i) {
        const double t = std::min(3.0, 0.1 * i);
        CHECK(walk.motion(t).velocity_world_mps.norm() == 0.0);
        CHECK(walk.motion(t).angular_velocity_body_radps.norm() == 0.0);
        CHECK(walk.motion(t).position_world_m == walk.motion(0).position_world_m);
      }
    }
  }
  GIVEN("the time after it has come up to speed") {
    double min_mps = 1e9;
    double max_mps = 0;
    double yaw_error_rad = 0;
    double largest_turn_radps = 0;
    for (int i = 0; i < 3500; ++i) {
      const double t = 5.0 + 0.01 * i;
      const Motion motion = walk.motion(t);
      const Vector3d& v = motion.velocity_world_mps;
      min_mps = std::min(min_mps, v.norm());
      max_mps = std::max(max_mps, v.norm());
      const double direction = std::atan2(v.y(), v.x());
      yaw_error_rad =
          std::max(yaw_error_rad,
                   std::abs(geometry::wrap_angle(geometry::yaw_of(motion.q_body_to_world) - direction)));
      largest_turn_radps = std::max(largest_turn_radps, std::abs(motion.angular_velocity_body_radps.z()));
    }
    THEN("it goes at about 1 m/s, turns, and looks where it goes") {
      CHECK(min_mps > 0.5);
      CHECK(max_mps < 1.5);
      CHECK(largest_turn_radps > 0.5);
      CHECK(yaw_error_rad < 1e-9);
    }
    THEN("its path is closed: one turn of its parameter later it is back, up to the bobbing") {
      const double period_s = 2.0 * std::numbers::pi / 0.45;
      const Vector3d way = walk.motion(6.0 + period_s).position_world_m - walk.motion(6.0).position_world_m;
      CHECK(way.head<2>().norm() < 1e-9);
      CHECK(std::abs(way.z()) < 0.021);
    }
  }
}

SCENARIO("a body that is tilted turns as the ZYX angles say") {
  GIVEN("a body pitched nose down by 1 rad that yaws at 2 rad/s") {
    const double pitch = 1.0;
    const Motion motion =
        motion_on({.x = 0, .y = 0, .z = 0, .yaw = {0.3, 2.0, 0.0}, .pitch = pitch, .roll = 0});
    THEN("its rate is along world Z, that is body x and z") {
      CHECK(motion.angular_velocity_body_radps.x() == Approx(-2.0 * std::sin(pitch)));
      CHECK(motion.angular_velocity_body_radps.y() == Approx(0.0).margin(1e-15));
      CHECK(motion.angular_velocity_body_radps.z() == Approx(2.0 * std::cos(pitch)));
      const Vector3d world = motion.q_body_to_world * motion.angular_velocity_body_radps;
      CHECK((world - Vector3d(0, 0, 2)).norm() < 1e-12);
    }
  }
}

SCENARIO("scenarios are found by name") {
  CHECK(find_scenario("rest").name == "rest");
  CHECK_THROWS_WITH(find_scenario("wlak"),
                    Catch::Contains("\"wlak\"") && Catch::Contains("rest, walk, circle"));
}

}  // namespace trajectory_test
