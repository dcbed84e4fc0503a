/// Alignment in motion by the fixes' velocity corrections.

#include <sonopose/estimation/documented/alignment.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <support/engine_driver.hpp>

namespace alignment_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

constexpr double gain_hz = 0.5;

AlignmentSettings learning() {
  AlignmentSettings settings;
  settings.tilt_gain_hz = gain_hz;
  settings.vertical_gain_hz = gain_hz;
  return settings;
}

attitude::AnyFilter filter_at(const Quaterniond& q_body_to_world) {
  attitude::AnyFilter filter;
  filter.reset(q_body_to_world);
  return filter;
}

TEST_CASE("a horizontal velocity correction tilts the attitude towards it") {
  GIVEN("a body at rest whose attitude is estimated level, and a fix that adds 0.2 m/s to the north-east") {
    auto filter = filter_at(geometry::rotation_about_z(0.7));
    AlignmentState state;
    const Vector3d change_world_mps(0.16, 0.12, 0.0);
    alignment::correct_tilt(learning(), state, filter, change_world_mps);
    THEN("its specific force now has gain × change along the correction, and yaw has not moved") {
      const Vector3d force_body = Vector3d(0, 0, standard_gravity_mps2);
      const Vector3d acceleration_world = filter.orientation() * force_body;
      CHECK(acceleration_world.x() == Approx(gain_hz * 0.16).epsilon(1e-3));
      CHECK(acceleration_world.y() == Approx(gain_hz * 0.12).epsilon(1e-3));
      CHECK(geometry::yaw_of(filter.orientation()) == Approx(0.7).margin(1e-4));
      CHECK(state.vertical_offset_mps2 == 0.0);
    }
  }
}

TEST_CASE("a vertical velocity correction is learned as an offset, up to its limit") {
  auto filter = filter_at(Quaterniond::Identity());
  AlignmentState state;
  alignment::correct_tilt(learning(), state, filter, {0, 0, -0.04});
  CHECK(state.vertical_offset_mps2 == Approx(-0.02));
  CHECK(filter.orientation().isApprox(Quaterniond::Identity()));
  for (int i = 0; i < 100; ++i) alignment::correct_tilt(learning(), state, filter, {0, 0, -1.0});
  CHECK(state.vertical_offset_mps2 == Approx(-AlignmentSettings{}.vertical_limit_mps2));
}

TEST_CASE("a gain of zero learns nothing") {
  AlignmentSettings off;
  off.tilt_gain_hz = 0.0;
  off.vertical_gain_hz = 0.0;
  off.aiding_s = 0.0;
  auto filter = filter_at(Quaterniond::Identity());
  AlignmentState state;
  alignment::correct_tilt(off, state, filter, {1, 2, 3});
  CHECK(filter.orientation().coeffs() == Quaterniond::Identity().coeffs());
  CHECK(state == AlignmentState{});
}

TEST_CASE("an acceleration that the fixes measure in another direction turns yaw and velocity") {
  AlignmentSettings settings;
  settings.yaw_gain = 0.5;
  settings.yaw_noise_mps = 0.3;
  auto filter = filter_at(geometry::rotation_about_z(0.2));
  auto body = test::moving_body({0.4, 0, 0});
  AlignmentState state;
  GIVEN("0.4 m/s gained along x by the IMU, which the fixes have seen along y") {
    state.gained_world_mps = {0.4, 0, 0};
    FixVelocity measured;
    measured.ultrasonic_world_mps = {0, 0.4, 0};
    measured.inertial_world_mps = {0.4, 0, 0};
    const YawTurn yaw = alignment::correct_yaw(settings, state, body, filter, measured, 0.25);
    const double turned_rad = yaw.turn_rad;
    THEN("yaw turns by the gain's share of 90 degrees, as far as the gain in speed stands out from noise") {
      const double certainty = 0.16 / (0.16 + 0.09);
      CHECK(turned_rad == Approx(0.5 * certainty * std::numbers::pi / 2));
      CHECK(geometry::yaw_of(filter.orientation()) == Approx(0.2 + turned_rad));
      CHECK(body.velocity_world_mps.x() == Approx(0.4 * std::cos(turned_rad)));
      CHECK(body.velocity_world_mps.y() == Approx(0.4 * std::sin(turned_rad)));
    }
    THEN("yaw is not known better, because the two gains have nothing in common") {
      CHECK(yaw.share == 0.0);
    }
    THEN("what the fix has corrected is forgotten") {
      CHECK(state.gained_world_mps.norm() == Approx(0.75 * 0.4));
    }
  }
  GIVEN("0.4 m/s gained along x by the IMU, which the fixes have seen too") {
    state.gained_world_mps = {0.4, 0, 0};
    const YawTurn yaw = alignment::correct_yaw(settings, state, body, filter, {}, 0.25);
    THEN("yaw does not turn, and it is known better by the gain's share") {
      CHECK(yaw.turn_rad == 0.0);
      CHECK(yaw.share == Approx(0.5 * 0.16 / (0.16 + 0.09)));
      CHECK(yaw.std_rad > 0.3 / 0.4);
    }
  }
  GIVEN("no acceleration") {
    FixVelocity measured;
    measured.ultrasonic_world_mps = {0, 0.4, 0};
    THEN("nothing is learned") {
      const YawTurn yaw = alignment::correct_yaw(settings, state, body, filter, measured, 0.25);
      CHECK(yaw.turn_rad == 0.0);
      CHECK(yaw.share == 0.0);
      CHECK(geometry::yaw_of(filter.orientation()) == Approx(0.2));
    }
  }
}

TEST_CASE("a single beacon that moves back and forth finds its heading") {
  // The body initially faces 45° and the engine assumes 0°; only motion reveals the difference.
  Settings settings;
  settings.alignment.yaw_gain = 0.2;
  test::EngineDriver driver(settings, test::eight());
  const auto yaw_error_deg = [](const test::Moment& moment) {
    return geometry::wrap_angle(geometry::yaw_of(moment.pose.q_body_to_world) - moment.truth.yaw_rad) /
           geometry::radians_per_degree;
  };
  CHECK(std::abs(yaw_error_deg(driver.run(0.1))) > 40.0);
  const auto moment = driver.run(20.0);
  CHECK(std::abs(yaw_error_deg(moment)) < 2.0);
  CHECK(moment.has(status_heading_unknown));
  CHECK(moment.position_error_m() < 0.03);
}

TEST_CASE("a velocity that the gate withheld does not tilt the attitude") {
  // The body drives a circle at 2 m/s and 2 rad/s: a gate at 1 rad/s leaves all of its turn to the fixes.
  Settings settings;
  settings.motion.gyro_gate_projection_radps = 1.0;
  settings.motion.gyro_gate_freeze_radps = 1.5;
  test::EngineDriver driver(settings, test::departure(2.0, 1.0), test::with_headings());
  driver.run(12.0);
  CHECK(driver.moments.back().has(status_rotating_fast));
  double worst_tilt_rad = 0.0;
  for (const test::Moment& moment : driver.moments) {
    const Vector3d up = geometry::up_in_body(moment.pose.q_body_to_world);
    worst_tilt_rad = std::max(worst_tilt_rad, std::acos(std::min(1.0, up.z())));
  }
  CHECK(worst_tilt_rad < 0.05);
}

TEST_CASE("a start with a wrong tilt is levelled by the fixes, without the accelerometer") {
  // The offset looks like a tilt of 2°; without the fixes the body would seem to accelerate by 0.34 m/s²
  // forever.
  GIVEN("an accelerometer with an offset of 0.34 m/s² that appears after the start") {
    Settings settings;
    settings.attitude.selection.filter = attitude::FilterKind::gyro;
    test::Sensors noisy;
    noisy.noise_m = 0.005;
    const auto residual_speed = [&](double tilt_gain_hz) {
      settings.alignment.tilt_gain_hz = tilt_gain_hz;
      test::EngineDriver driver(settings, test::at_rest(), noisy);
      driver.alter_imu = [](ImuSample& imu, double time_s) {
        if (time_s > 3.0) imu.specific_force_body_mps2.x() += 0.34;
      };
      driver.run(30.0);
      double worst_mps = 0.0;
      for (const test::Moment& moment : driver.moments) {
        if (moment.time_s > 29.0) worst_mps = std::max(worst_mps, moment.pose.velocity_world_mps.norm());
      }
      return worst_mps;
    };
    THEN("levelling takes the false speed away") {
      const double without_mps = residual_speed(0.0);
      CHECK(without_mps > 0.03);
      CHECK(residual_speed(0.5) < 0.2 * without_mps);
    }
  }
}

}  // namespace alignment_test
