/// Units and axes of an IMU in motion.

#include "doctor/replayed.hpp"
#include "support/events.hpp"
#include "support/seeds.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <map>

namespace imu_test {

using namespace sonopose;
using namespace sonopose::doctor::test;
using Catch::Contains;

/// Problems found in eight seconds of a drive whose IMU samples are changed.
std::string problems_with(const char* scenario, const std::function<void(ImuSample&)>& change) {
  static std::map<std::string, std::vector<Event>> drives;
  if (!drives.contains(scenario)) drives[scenario] = events_of(scenario, 1951, 16.5);
  auto events = drives[scenario];
  for (auto* imu : sonopose::test::each<ImuSample>(events)) change(*imu);
  return problems_of(observed(events, {}, {8, 8}));
}

/// Turns the axes of both sensors.
auto turned(const Eigen::Matrix3d& sensor_from_body) {
  return [sensor_from_body](ImuSample& imu) {
    imu.angular_velocity_body_radps = sensor_from_body * imu.angular_velocity_body_radps;
    imu.specific_force_body_mps2 = sensor_from_body * imu.specific_force_body_mps2;
  };
}

SCENARIO("wrong axes and units of an IMU are found in motion, and nothing else is blamed") {
  for (const char* const scenario : {"walk", "kart", "forklift", "hall", "drone"}) {
    GIVEN(std::string("a drive of ") + scenario) {
      const auto check = [&](const std::string& problems, const char* finding, const char* setting) {
        CAPTURE(problems);
        CHECK_THAT(problems, Contains(finding) && Contains(setting));
        CHECK(std::count(problems.begin(), problems.end(), '\n') == 1);  // and none of its consequences
      };
      WHEN("its axes are forward, right, down") {
        THEN("the vertical axis is named, with the axes to set") {
          check(problems_with(scenario, turned(Eigen::Vector3d(1, -1, -1).asDiagonal())),
                "specific force is along -z", "calibration.axes=+x-y-z");
        }
      }
      WHEN("it lies on its side") {
        const Eigen::Matrix3d sensor_from_body =
            geometry::rotation_by(Vector3d(0.5 * std::numbers::pi, 0, 0)).toRotationMatrix();
        THEN("the axis that points up is named") {
          check(problems_with(scenario, turned(sensor_from_body)), "specific force is along -y",
                "calibration.axes=+x+z-y");
        }
      }
      WHEN("the force is in g") {
        THEN("the unit and the factor are named") {
          check(problems_with(scenario,
                              [](ImuSample& imu) { imu.specific_force_body_mps2 /= standard_gravity_mps2; }),
                "seems to be in g",
                "calibration.accelerometer.sensitivity_x, sensitivity_y and sensitivity_z to 9.807");
        }
      }
      WHEN("the force is in mg or cm/s^2") {
        const double unit = GENERATE(1e3 / standard_gravity_mps2, 1e2);
        THEN("the units are named") {
          check(problems_with(scenario, [unit](ImuSample& imu) { imu.specific_force_body_mps2 *= unit; }),
                "seems to be in mg or cm/s", "publish m/s²");
        }
      }
      WHEN("the rates are in deg/s") {
        THEN("the unit and the factor are named") {
          check(problems_with(
                    scenario,
                    [](ImuSample& imu) { imu.angular_velocity_body_radps /= geometry::radians_per_degree; }),
                "seems to be in deg/s",
                "calibration.gyroscope.sensitivity_x, sensitivity_y and sensitivity_z to 0.01745");
        }
      }
      WHEN("the rates are in mdeg/s") {
        THEN("the unit is named, and no factor, since it is below the limits of the setting") {
          check(problems_with(scenario,
                              [](ImuSample& imu) {
                                imu.angular_velocity_body_radps *= 1e3 / geometry::radians_per_degree;
                              }),
                "seems to be in mdeg/s", "publish rad/s");
        }
      }
      WHEN("gravity was removed") {
        THEN("that is named") {
          check(problems_with(
                    scenario,
                    [](ImuSample& imu) { imu.specific_force_body_mps2.z() -= standard_gravity_mps2; }),
                "does not measure gravity", "raw data");
        }
      }
    }
  }
}

SCENARIO("an axis of the IMU that does not change is named, and none of its consequences") {
  struct Dead {
    const char* named;
    Vector3d ImuSample::*reading;
    Eigen::Index axis;
  };
  const Dead dead = GENERATE(Dead{"axis z of the gyroscope", &ImuSample::angular_velocity_body_radps, 2},
                             Dead{"axis x of the accelerometer", &ImuSample::specific_force_body_mps2, 0},
                             Dead{"axis z of the accelerometer", &ImuSample::specific_force_body_mps2, 2});
  for (const char* const scenario : {"walk", "kart", "forklift", "spin", "hall"}) {
    GIVEN(std::string("a drive of ") + scenario + " without " + dead.named) {
      const std::string problems =
          problems_with(scenario, [&](ImuSample& imu) { (imu.*dead.reading)(dead.axis) = 0; });
      CAPTURE(problems);
      CHECK_THAT(problems, Contains(dead.named + std::string(" is stuck at 0")));
      CHECK_THAT(problems, !Contains("delay") && !Contains("track") && !Contains("mount") &&
                               !Contains("gravity") && !Contains("gyro bias"));
    }
  }
}

SCENARIO("an IMU that repeats a sample, reads nothing or has a dead gyroscope is named, and no consequence",
         "[accuracy]") {
  const auto in_stretch = [](const std::function<void(ImuSample&, const ImuSample&)>& change) {
    return [change, begin_ns = TimeNs{0}, frozen = ImuSample()](ImuSample& imu) mutable {
      if (begin_ns == 0) begin_ns = imu.sensor_time_ns;
      const double time_s = seconds_between(begin_ns, imu.sensor_time_ns);
      if (time_s < 10 || time_s > 13) {
        frozen = imu;
      } else {
        change(imu, frozen);
      }
    };
  };
  const bool all = sonopose::test::seeds(1, 2) == 2;  // otherwise each fault in one scenario
  int scenarios = 0;
  for (const char* const scenario : {"walk", "kart", "forklift"}) {
    const int number = scenarios++;
    GIVEN(std::string("a drive of ") + scenario) {
      int faults = 0;
      const auto check = [&](const auto& change, const char* finding) {
        if (faults++ != number && !all) return;
        const std::string problems = problems_with(scenario, change);
        CAPTURE(problems);
        CHECK_THAT(problems, Contains(finding));
        CHECK(std::count(problems.begin(), problems.end(), '\n') == 1);
      };
      check(in_stretch([](ImuSample& imu, const ImuSample& frozen) {
              imu.angular_velocity_body_radps = frozen.angular_velocity_body_radps;
              imu.specific_force_body_mps2 = frozen.specific_force_body_mps2;
            }),
            "the IMU repeats one sample for 3.0");
      check(in_stretch([](ImuSample& imu, const ImuSample&) {
              imu.angular_velocity_body_radps.setZero();
              imu.specific_force_body_mps2.setZero();
            }),
            "the accelerometer reads 0 0 0 for 3.0");
      check([](ImuSample& imu) { imu.angular_velocity_body_radps.setZero(); },
            "the gyroscope is stuck at 0.00 0.00 0.00 rad/s");
    }
  }
}

SCENARIO("an IMU whose clock is ahead is named, with the correction beyond the range of the setting") {
  for (const char* const scenario : {"walk", "kart", "forklift"}) {
    GIVEN(std::string("a drive of ") + scenario + " whose IMU stamps are 0.4 s ahead") {
      const std::string problems =
          problems_with(scenario, [](ImuSample& imu) { imu.sensor_time_ns += 400'000'000; });
      CAPTURE(problems);
      CHECK_THAT(problems, Contains("the stamps of fixes and IMU are of different clocks") &&
                               (Contains("or add 0.40") || Contains("or add 0.39")));
      // A fix counts if its time of measurement is at most 0.3 s after its receipt, 68 ms after the emission.
      const std::string before = "delay.correction_s allows only ";
      const std::size_t at = problems.find(before);
      REQUIRE(at != std::string::npos);
      CHECK(std::stod(problems.substr(at + before.size())) == Approx(-0.3 - 0.068).margin(0.012));
    }
  }
}

SCENARIO("a gyroscope that senses too little or nothing of the turns is named") {
  const auto scaled = [](double factor) {
    return [factor](ImuSample& imu) {
      // Noise remains on a dead axis.
      const double noise_radps = 0.01 * imu.specific_force_body_mps2.x();
      imu.angular_velocity_body_radps.z() = factor * imu.angular_velocity_body_radps.z() + noise_radps;
    };
  };
  for (const char* const scenario : {"walk", "kart", "spin"}) {
    GIVEN(std::string("a drive of ") + scenario) {
      CHECK_THAT(problems_with(scenario, scaled(0)),
                 Contains("the vertical axis is dead") && !Contains("delay"));
      CHECK_THAT(problems_with(scenario, scaled(0.5)),
                 Contains("its scale is wrong") && Contains("multiply calibration.gyroscope.sensitivity_x"));
    }
  }
}

}  // namespace imu_test
