#include "motion/imu_summary.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>

namespace imu_summary_test {

using namespace sonopose;
using namespace sonopose::motion;

constexpr double per_degree = geometry::radians_per_degree;

/// Twenty seconds at 100 Hz of a body that rolls to and fro by `amplitude_rad`, every three seconds.
std::vector<Reading> rolling(double amplitude_rad, const std::function<void(Reading&)>& change) {
  std::vector<Reading> readings;
  constexpr double frequency_radps = 2 * std::numbers::pi / 3.0;
  for (int i = 0; i < 2000; ++i) {
    const double time_s = 0.01 * i;
    const double roll_rad = amplitude_rad * std::sin(frequency_radps * time_s);
    Reading reading{.time_ns = 10'000'000LL * i};
    reading.rate_body_radps.x() = amplitude_rad * frequency_radps * std::cos(frequency_radps * time_s);
    reading.force_body_mps2 = standard_gravity_mps2 * Vector3d(0, std::sin(roll_rad), std::cos(roll_rad));
    change(reading);
    readings.push_back(reading);
  }
  return readings;
}

SCENARIO("the unit of the rates is judged by what gravity does") {
  for (const double amplitude_rad : {3 * per_degree, 60 * per_degree}) {
    GIVEN("a body that rolls by " + std::to_string(amplitude_rad) + " rad") {
      THEN("rates in rad/s agree with it, and rates in deg/s do not") {
        CHECK_FALSE(has_rates_in_degrees(summary_of(rolling(amplitude_rad, [](Reading&) {}))));
        CHECK(has_rates_in_degrees(summary_of(
            rolling(amplitude_rad, [](Reading& reading) { reading.rate_body_radps /= per_degree; }))));
      }
    }
  }
  GIVEN("a multicopter that rolls by 20°, whose thrust is always along its own axis") {
    const auto thrust = [](Reading& reading) { reading.force_body_mps2 = {0, 0, standard_gravity_mps2}; };
    THEN("its rates are accepted") {
      CHECK_FALSE(has_rates_in_degrees(summary_of(rolling(20 * per_degree, thrust))));
    }
  }
  GIVEN("a vehicle that turns on a level floor by 20 deg/s") {
    const auto turning = [](double rate_radps) {
      return summary_of(rolling(0, [&](Reading& reading) { reading.rate_body_radps.z() = rate_radps; }));
    };
    THEN("the number 20 is too fast for rad/s") {
      CHECK_FALSE(has_rates_in_degrees(turning(20 * per_degree)));
      CHECK(has_rates_in_degrees(turning(20.5)));
    }
  }
}

SCENARIO("the unit of the force is judged by gravity") {
  const auto unit_with = [](const std::function<void(Reading&)>& change) {
    return force_unit_of(summary_of(rolling(10 * per_degree, change)));
  };
  CHECK(unit_with([](Reading&) {}) == ForceUnit::mps2);
  CHECK(unit_with([](Reading& r) { r.force_body_mps2 /= standard_gravity_mps2; }) == ForceUnit::g);
  CHECK(unit_with([](Reading& r) { r.force_body_mps2 *= 1000 / standard_gravity_mps2; }) == ForceUnit::mg);
  CHECK(unit_with([](Reading& r) { r.force_body_mps2 *= 3; }) == ForceUnit::unknown);
  CHECK(unit_with([](Reading& r) {
          const double time_s = 1e-9 * static_cast<double>(r.time_ns);
          r.force_body_mps2 = {std::sin(2 * time_s), std::cos(3 * time_s), 0.1};
        }) == ForceUnit::no_gravity);
}

SCENARIO("a summary of nothing judges nothing") {
  const ImuSummary nothing = summary_of({});
  CHECK(nothing.duration_s == 0.0);
  CHECK_FALSE(has_rates_in_degrees(nothing));
}

}  // namespace imu_summary_test
