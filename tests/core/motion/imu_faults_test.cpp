#include "motion/imu_faults.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

namespace imu_faults_test {

using namespace sonopose;
using namespace sonopose::motion;
using Catch::Contains;

/// Twenty seconds of a body that circles at this speed, with the noise of a sensor. `change` is by time.
Window circling(double speed_mps, const std::function<void(Reading&, double)>& change) {
  constexpr double radius_m = 3.0;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  const auto noise3 = [&] { return Vector3d(noise(random), noise(random), noise(random)); };
  const double rate_radps = speed_mps / radius_m;
  Window window;
  for (int i = 0; i < 2000; ++i) {
    Reading reading{.time_ns = 10'000'000LL * i};
    reading.rate_body_radps = Vector3d(0, 0, rate_radps) + noise3();
    reading.force_body_mps2 = Vector3d(0, speed_mps * rate_radps, standard_gravity_mps2) + noise3();
    const double time_s = 0.01 * i;
    change(reading, time_s);
    window.imu.push_back(reading);
    if (i % 12 != 0) continue;
    const double angle_rad = rate_radps * time_s;
    window.fixes.push_back(
        {reading.time_ns, radius_m * Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0) + 2.0 * noise3()});
  }
  return window;
}

/// The findings in one text.
std::string faults_of(double speed_mps, const std::function<void(Reading&, double)>& change) {
  std::string all;
  for (const std::string& text : imu_faults_of(circling(speed_mps, change))) all += text + "; ";
  return all;
}

SCENARIO("a right IMU has no fault, moving or not") {
  for (const double speed_mps : {0.0, 0.3, 3.0}) {
    CHECK(faults_of(speed_mps, [](Reading&, double) {}).empty());
    // As a sensor with coarse steps, of which every third sample is sent twice.
    Reading before;
    CHECK(faults_of(speed_mps, [&before, i = 0](Reading& reading, double) mutable {
            reading.rate_body_radps = (reading.rate_body_radps / 0.01).array().round() * 0.01;
            if (++i % 3 == 0) {
              reading.rate_body_radps = before.rate_body_radps;
              reading.force_body_mps2 = before.force_body_mps2;
            }
            before = reading;
          }).empty());
  }
}

SCENARIO("an IMU that repeats one sample is found while the body moves") {
  const auto freezes = [](double from_s, double to_s) {
    return [from_s, to_s, frozen = Reading()](Reading& reading, double time_s) mutable {
      if (time_s < from_s || time_s >= to_s) {
        frozen = reading;
      } else {
        reading.rate_body_radps = frozen.rate_body_radps;
        reading.force_body_mps2 = frozen.force_body_mps2;
      }
    };
  };
  CHECK(faults_of(1.0, freezes(5, 8)) == "the IMU repeats one sample for 3.00 s; ");
  CHECK_THAT(faults_of(1.0, freezes(0.005, 20)), Contains("the IMU repeats one sample for 19.99 s"));
  // A full circle, back to where it began.
  CHECK_THAT(faults_of(2.0 * std::numbers::pi * 3.0 / 10.0, freezes(5, 15)),
             Contains("the IMU repeats one sample for 10.00 s"));
  CHECK(faults_of(1.0, freezes(5, 5.2)).empty());  // a lost packet or two
  // A simulation without noise may do so at rest.
  CHECK(faults_of(0.0, freezes(5, 8)).empty());
  CHECK(faults_of(0.0, freezes(0.005, 20)).empty());
  auto first = freezes(5, 8);
  auto second = freezes(12, 13);
  CHECK(faults_of(1.0, [&](Reading& reading, double time_s) {
          first(reading, time_s);
          second(reading, time_s);
        }) == "the IMU repeats one sample for up to 3.00 s, 4.00 s in total; ");
}

SCENARIO("steady motion in a simulation without noise repeats samples, but is no fault") {
  Window window = circling(1.0, [](Reading& reading, double time_s) {
    const double rate_radps = time_s < 8 ? 0.0 : 0.1 * (time_s - 8);
    reading.rate_body_radps = {0, 0, rate_radps};
    reading.force_body_mps2 = {0, rate_radps, standard_gravity_mps2};
  });
  for (const std::string& fault : imu_faults_of(window)) CHECK_THAT(fault, !Contains("repeats"));
}

SCENARIO("an accelerometer that reads nothing is found, moving or not") {
  for (const double speed_mps : {0.0, 1.0}) {
    CHECK(faults_of(speed_mps, [](Reading& reading, double time_s) {
            if (time_s >= 5 && time_s < 8) reading = {.time_ns = reading.time_ns};
          }) == "the accelerometer reads 0 0 0 for 2.99 s; ");
  }
}

SCENARIO("two IMUs on one topic are found by samples that alternate") {
  const double speed_mps = GENERATE(0.0, 3.0);
  int i = 0;
  WHEN("one has a bias") {
    const std::string faults = faults_of(speed_mps, [&](Reading& reading, double) {
      if (++i % 2 == 0) reading.force_body_mps2 += Vector3d(0.1, -0.05, 0.05);
    });
    THEN("they are named") {
      CHECK_THAT(faults, Contains("two IMUs publish on one topic"));
    }
  }
  WHEN("one is turned and something vibrates") {
    const std::string faults = faults_of(speed_mps, [&](Reading& reading, double time_s) {
      reading.force_body_mps2.x() += std::sin(2.0 * std::numbers::pi * 17.0 * time_s);
      if (++i % 2 == 0) reading.force_body_mps2 = reading.force_body_mps2.reverse().eval();
    });
    THEN("they are named") {
      CHECK_THAT(faults, Contains("two IMUs publish on one topic"));
    }
  }
}

SCENARIO("vibration is no second IMU") {
  const double frequency_hz = GENERATE(5.0, 17.0, 30.0, 38.0, 45.0, 48.5, 61.0);
  CHECK(faults_of(3.0, [&](Reading& reading, double time_s) {
          reading.force_body_mps2.x() += 3.0 * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s);
        }).empty());
}

SCENARIO("a sensor that is stuck as a whole is found while the body moves") {
  const auto without_rates = [](Reading& reading, double) { reading.rate_body_radps.setZero(); };
  CHECK(faults_of(1.0, without_rates) == "the gyroscope is stuck at 0.00 0.00 0.00 rad/s; ");
  CHECK(faults_of(0.0, without_rates).empty());  // some suppress their noise
  CHECK(faults_of(1.0, [](Reading& reading, double) {
          reading.force_body_mps2 = {0, 0, 9.81};
        }) == "the accelerometer is stuck at 0.00 0.00 9.81 m/s^2; ");
}

SCENARIO("a stuck axis is found, moving or not") {
  for (const double speed_mps : {0.0, 1.0}) {
    CHECK(faults_of(speed_mps, [](Reading& reading, double) { reading.rate_body_radps.z() = 0.5; }) ==
          "axis z of the gyroscope is stuck at 0.50 rad/s; ");
  }
}

SCENARIO("held readings can be removed, and the others show no fault") {
  Reading held;
  Window window = circling(1.0, [&held](Reading& reading, double time_s) {
    if (time_s > 4.995 && time_s < 5.995) reading.force_body_mps2.setZero();
    if (time_s < 9.995) {
      held = reading;
    } else if (time_s < 10.995) {
      reading.rate_body_radps = held.rate_body_radps;
      reading.force_body_mps2 = held.force_body_mps2;
    }
  });
  REQUIRE(imu_faults_of(window).size() == 1);
  const std::size_t readings = window.imu.size();
  remove_held_readings(window);
  CHECK(imu_faults_of(window).empty());
  CHECK(window.imu.size() == readings - 100 - 101);  // of the repeated samples the first one too
}

}  // namespace imu_faults_test
