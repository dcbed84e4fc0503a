/// Consistency of the simulated IMU with the truth: integrating it without noise must reproduce the truth.

#include "sim/simulator.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <string>

namespace strapdown_test {

using namespace sonopose;
using namespace sonopose::sim;

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

struct Drift {
  double position_m = 0;
  double velocity_mps = 0;
  double angle_rad = 0;
};

/// Strapdown integration by the trapezoid rule, independent of the project's implementation.
class Strapdown {
public:
  Strapdown(const Motion& start, const Vector3d& lever_m)
      : q_{start.q_body_to_world},
        velocity_{start.velocity_world_mps + q_ * start.angular_velocity_body_radps.cross(lever_m)},
        position_{start.position_world_m + q_ * lever_m} {}

  void on(const ImuSample& imu) {
    if (last_) {
      const double dt = seconds_between(last_->sensor_time_ns, imu.sensor_time_ns);
      const Vector3d before = q_ * last_->specific_force_body_mps2;
      q_ = q_ * geometry::rotation_by(0.5 * dt *
                                      (last_->angular_velocity_body_radps + imu.angular_velocity_body_radps));
      const Vector3d acceleration =
          0.5 * (before + q_ * imu.specific_force_body_mps2) - Vector3d(0, 0, 9.80665);
      position_ += velocity_ * dt + 0.5 * dt * dt * acceleration;
      velocity_ += acceleration * dt;
    }
    last_ = imu;
  }

  [[nodiscard]] Drift drift_from(const TruthSample& truth, const Vector3d& rate,
                                 const Vector3d& lever) const {
    return {(position_ - q_ * lever - truth.position_world_m).norm(),
            (velocity_ - q_ * rate.cross(lever) - truth.velocity_world_mps).norm(),
            q_.angularDistance(truth.q_body_to_world)};
  }

private:
  Quaterniond q_;
  Vector3d velocity_;
  Vector3d position_;
  std::optional<ImuSample> last_;
};

/// Drift after 20 s of the scenario with a perfect IMU of this rate, mounted at `lever` from the tracked
/// point.
Drift drift_after_20_s(const Scenario& scenario, double rate_hz, const Vector3d& lever = Vector3d::Zero()) {
  SensorSettings settings = SensorSettings::ideal();
  settings.imu_rate_hz = rate_hz;
  settings.imu_from_tracked_point_body_m = lever;
  Simulator simulator(scenario, settings, {.start_time_ns = start_ns, .duration_s = 20.0});
  Strapdown strapdown(simulator.motion_at(start_ns), lever);
  Drift drift;
  while (const auto step = simulator.next()) {
    if (!step->truth) continue;
    const auto& imu = std::get<ImuSample>(step->event);
    strapdown.on(imu);
    drift = strapdown.drift_from(*step->truth, imu.angular_velocity_body_radps, lever);
  }
  return drift;
}

SCENARIO("a perfect IMU integrates back to the truth of every harder scenario, too") {
  for (const Scenario& variable : harder_scenarios()) {
    GIVEN("20 s of " + std::string(variable.name) + " at 1 kHz") {
      Scenario scenario = drawn(variable, {.seed = 1});
      scenario.disturbances = {};
      const Drift drift = drift_after_20_s(scenario, 1000.0);
      THEN("pure integration ends within millimetres, shaken or not") {
        CHECK(drift.position_m < 3e-3);
        CHECK(drift.velocity_mps < 1e-3);
        CHECK(drift.angle_rad < 3e-5);
      }
    }
  }
}

SCENARIO("a perfect IMU integrates back to the truth") {
  for (Scenario scenario : scenarios()) {
    scenario.disturbances = {};
    GIVEN("20 s of " + std::string(scenario.name) + " at 1 kHz") {
      const Drift drift = drift_after_20_s(scenario, 1000.0);
      THEN("pure integration ends within a millimetre") {
        CHECK(drift.position_m < 1e-3);
        CHECK(drift.velocity_mps < 1e-4);
        CHECK(drift.angle_rad < 1e-5);
      }
    }
  }
}

SCENARIO("the integration's error falls with the square of the step, as the trapezoid rule's does") {
  for (const char* name : {"walk", "circle", "kart", "drone"}) {
    GIVEN(std::string("the scenario ") + name) {
      const Scenario& scenario = find_scenario(name);
      const double coarse_m = drift_after_20_s(scenario, 125.0).position_m;
      const double middle_m = drift_after_20_s(scenario, 250.0).position_m;
      const double fine_m = drift_after_20_s(scenario, 500.0).position_m;
      INFO("position errors " << coarse_m << ", " << middle_m << ", " << fine_m << " m");
      THEN("half the step has a quarter of the error") {
        CHECK(coarse_m / middle_m == Approx(4.0).epsilon(0.15));
        CHECK(middle_m / fine_m == Approx(4.0).epsilon(0.15));
      }
    }
  }
}

SCENARIO("an IMU off the tracked point feels its own motion") {
  const Vector3d lever(0.06, -0.03, 0.02);
  GIVEN("an IMU 7 cm off the tracked point, on the bobbing walk") {
    THEN("its integral is its own path; less the lever arm, the tracked point's") {
      const Drift drift = drift_after_20_s(find_scenario("walk"), 1000.0, lever);
      CHECK(drift.position_m < 1e-3);
      CHECK(drift.velocity_mps < 1e-4);
    }
  }
  GIVEN("a body that spins at 9 rad/s about the tracked point") {
    Motion spin;
    spin.angular_velocity_body_radps = {0, 0, 9.0};
    THEN("an IMU 6 cm out feels ω²r towards the axis") {
      const ImuSample imu = ideal_imu_sample(spin, {0.06, 0, 0});
      CHECK(imu.specific_force_body_mps2.x() == Approx(-4.86));
      CHECK(imu.specific_force_body_mps2.z() == Approx(9.80665));
    }
  }
}

SCENARIO("the IMU's signs are those of the log format") {
  GIVEN("a level body at rest") {
    const ImuSample imu = ideal_imu_sample(find_scenario("rest").motion(1.0));
    THEN("it reads +9.81 on z and no rate") {
      CHECK((imu.specific_force_body_mps2 - Vector3d(0, 0, 9.80665)).norm() < 1e-12);
      CHECK(imu.angular_velocity_body_radps.norm() == 0.0);
    }
  }
  GIVEN("a kart that turns left at 6 m/s on a radius of 8 m") {
    const ImuSample imu = ideal_imu_sample(find_scenario("circle").motion(15.0));
    THEN("it turns counter-clockwise and is pulled to its left by v²/r") {
      CHECK(imu.angular_velocity_body_radps.z() == Approx(6.0 / 8.0));
      CHECK(imu.specific_force_body_mps2.x() == Approx(0.0).margin(1e-9));
      CHECK(imu.specific_force_body_mps2.y() == Approx(36.0 / 8.0));
    }
  }
}

}  // namespace strapdown_test
