/// A simulated drone pitches, rolls and yaws one after the other; the fused poses, as PX4 and MAVLink get
/// them, have the signs of the autopilots' documents: nose up, right side down and a turn to the right are
/// positive.

#include "autopilot/ardupilot.hpp"
#include "autopilot/px4.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace attitude_signs_test {

using namespace sonopose;
using autopilot::ExternalOdometry;
using sim::Jet;

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;
constexpr double pitch_rad = 0.35;
constexpr double roll_rad = 0.5;
constexpr double turn_rad = 1.2;

/// From 0 to 1 and back within 4 s from `begin_s` on.
Jet there_and_back(double time_s, double begin_s) {
  const Jet time{time_s, 1, 0};
  return sim::smooth_step((time - begin_s) * 0.5) - sim::smooth_step((time - (begin_s + 2)) * 0.5);
}

/// Faces the map's y, 3 m up. Our pitch (ZYX, z up) is nose down.
sim::Path path(double time_s) {
  const Jet time{time_s, 1, 0};
  const Jet forward = 4.0 * sim::smooth_step((time - 24.0) * 0.25);
  return {.x = Jet(1.0),
          .y = Jet(2.0) + forward,
          .z = Jet(3.0),
          .yaw = Jet(std::numbers::pi / 2) - turn_rad * there_and_back(time_s, 18),
          .pitch = -pitch_rad * there_and_back(time_s, 6),
          .roll = roll_rad * there_and_back(time_s, 12)};
}

const std::vector<FusedPose>& flown() {
  static const auto poses = [] {
    sim::Scenario scenario{.name = "signs", .summary = "", .path = path};
    scenario.sensors = sim::SensorSettings::ideal();
    scenario.duration_s = 30;
    estimation::AnyEstimator engine(settings::Settings{});
    return test::poses_of(engine, sim::record(scenario, {.start_time_ns = start_ns}).events);
  }();
  return poses;
}

FusedPose pose_at(double time_s) {
  for (const FusedPose& pose : flown()) {
    if (seconds_between(start_ns, pose.time_ns) >= time_s) return pose;
  }
  throw std::runtime_error("the flight is too short");
}

/// North is y, as in ENU.
constexpr double north_is_y = std::numbers::pi / 2;

ExternalOdometry in_ned(double time_s) {
  return autopilot::external_odometry(pose_at(time_s), {}, north_is_y);
}

/// ZYX angles of FRD in NED: the roll, pitch and yaw of aviation.
geometry::EulerAngles<double> angles_of(const ExternalOdometry& odometry) {
  REQUIRE(odometry.q_body_to_frame);
  return geometry::euler_angles_of(*odometry.q_body_to_frame);
}

constexpr double close_rad = 0.03;

SCENARIO("an autopilot gets the attitude with its own signs") {
  GIVEN("a drone that faces north") {
    const auto level = angles_of(in_ned(5.5));
    THEN("all its angles are zero") {
      CHECK(level.roll_rad == Approx(0).margin(close_rad));
      CHECK(level.pitch_rad == Approx(0).margin(close_rad));
      CHECK(level.yaw_rad == Approx(0).margin(close_rad));
    }
    WHEN("its nose goes up") {
      THEN("pitch and pitch rate are positive, and nothing else changes") {
        const auto angles = angles_of(in_ned(8));
        CHECK(angles.pitch_rad == Approx(pitch_rad).margin(close_rad));
        CHECK(angles.roll_rad == Approx(0).margin(close_rad));
        CHECK(angles.yaw_rad == Approx(0).margin(close_rad));
        CHECK(in_ned(7).angular_velocity_body_radps.y() > 0.2);
        CHECK(in_ned(9).angular_velocity_body_radps.y() < -0.2);
      }
    }
    WHEN("its right side goes down") {
      THEN("roll and roll rate are positive") {
        const auto angles = angles_of(in_ned(14));
        CHECK(angles.roll_rad == Approx(roll_rad).margin(close_rad));
        CHECK(angles.pitch_rad == Approx(0).margin(close_rad));
        CHECK(in_ned(13).angular_velocity_body_radps.x() > 0.2);
      }
    }
    WHEN("it turns to the right, towards east") {
      THEN("yaw and yaw rate are positive") {
        const auto angles = angles_of(in_ned(20));
        CHECK(angles.yaw_rad == Approx(turn_rad).margin(close_rad));
        CHECK(angles.roll_rad == Approx(0).margin(close_rad));
        CHECK(in_ned(19).angular_velocity_body_radps.z() > 0.2);
      }
    }
    WHEN("it flies north") {
      const ExternalOdometry odometry = in_ned(26);
      THEN("north and forward are positive, and height is negative") {
        CHECK(odometry.velocity_frame_mps.x() > 1);
        CHECK(odometry.velocity_body_mps.x() > 1);
        CHECK(odometry.velocity_frame_mps.tail<2>().norm() < 0.1);
        CHECK(in_ned(29.5).position_frame_m.isApprox(Vector3d(6, 1, -3), 0.02));
      }
    }
  }
  GIVEN("the same drone, where x is north") {
    THEN("it faces west, and flies there") {
      const auto odometry = autopilot::external_odometry(pose_at(26), {}, 0.0);
      CHECK(angles_of(odometry).yaw_rad == Approx(-std::numbers::pi / 2).margin(close_rad));
      CHECK(odometry.velocity_frame_mps.y() < -1);
      CHECK(odometry.velocity_body_mps.x() > 1);
    }
  }
  GIVEN("ArduPilot's transform of the drone with its nose up, 3 m up") {
    const autopilot::ArduPilotFrames frames;
    const auto transform = autopilot::ardupilot_transform(in_ned(8), 1, frames).transform;
    THEN("it is north, west, up, where nose up is a turn about minus y") {
      CHECK(transform.translation.x == Approx(2).margin(0.02));
      CHECK(transform.translation.y == Approx(-1).margin(0.02));
      CHECK(transform.translation.z == Approx(3).margin(0.02));
      CHECK(transform.rotation.w == Approx(std::cos(pitch_rad / 2)).margin(close_rad));
      CHECK(transform.rotation.y == Approx(-std::sin(pitch_rad / 2)).margin(close_rad));
    }
  }
  GIVEN("PX4's message of the drone with its nose up") {
    const auto message = autopilot::vehicle_odometry(in_ned(8), 8'000'000'000, 8'010'000'000, 3, 90);
    THEN("the quaternion has w first and the body's y second to last") {
      CHECK(message.q[0] == Approx(std::cos(pitch_rad / 2)).margin(close_rad));
      CHECK(message.q[2] == Approx(std::sin(pitch_rad / 2)).margin(close_rad));
      CHECK(std::abs(message.q[1]) < close_rad);
      CHECK(message.pose_frame == 1);
      CHECK(message.timestamp_sample == 8'000'000);
      CHECK(message.timestamp == 8'010'000);
      CHECK(int{message.reset_counter} == 3);
      CHECK(int{message.quality} == 90);
    }
  }
}

}  // namespace attitude_signs_test
