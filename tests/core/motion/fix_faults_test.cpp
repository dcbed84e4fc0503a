#include "motion/fix_faults.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <string>

namespace fix_faults_test {

using namespace sonopose;
using namespace sonopose::motion;
using Catch::Contains;

/// Twenty seconds of a body that circles at 2 m/s and faces its way, with a fix and a heading at 8 Hz.
Window circling(const std::function<void(Position&, int)>& change) {
  constexpr double radius_m = 3.0;
  constexpr double rate_radps = 2.0 / radius_m;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.02);
  Window window;
  for (int i = 0; i < 2000; ++i) {
    const double angle_rad = 0.01 * i * rate_radps;
    const TimeNs time_ns = 10'000'000LL * i;
    // Twice in a turn it brakes and speeds up.
    const Vector3d force_mps2(std::sin(2 * angle_rad), 2.0 * rate_radps, standard_gravity_mps2);
    window.imu.push_back({time_ns, {0, 0, rate_radps}, force_mps2});
    if (i % 12 != 0) continue;
    const Vector3d noise_m(noise(random), noise(random), noise(random));
    window.fixes.push_back(
        {time_ns, radius_m * Vector3d(2.0 + std::cos(angle_rad), std::sin(angle_rad), 0.5) + noise_m});
    change(window.fixes.back(), i / 12);
    window.headings.push_back({time_ns, geometry::wrap_angle(angle_rad)});
  }
  return window;
}

std::vector<FixFault> faults_of(const Window& window) {
  return fix_faults_of(window, turn_gain_of(window));
}

SCENARIO("right fixes have no fault, also with reflections, a freeze and a jump") {
  CHECK(faults_of(circling([](Position&, int) {})).empty());
  CHECK(faults_of(circling([](Position& fix, int i) {
          if (i % 5 == 0) fix.position_world_m += Vector3d(0.8, -1.0, 0.2);
        })).empty());
  std::optional<Position> frozen;
  CHECK(faults_of(circling([&](Position& fix, int i) {
          if (i == 40) frozen = fix;
          if (i > 40 && i < 80) fix.position_world_m = frozen->position_world_m;
        })).empty());
}

SCENARIO("fixes in another unit are found") {
  const double unit = GENERATE(100.0, 1000.0);
  const auto faults = faults_of(circling([&](Position& fix, int) { fix.position_world_m *= unit; }));
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].kind == FixFaultKind::unit);
  CHECK_THAT(faults[0].text, Contains("the positions accelerate by more than"));
}

SCENARIO("a default position among the fixes is found, and counted") {
  const Vector3d default_m = GENERATE(Vector3d(0, 0, 0), Vector3d(-1, -1, -1), Vector3d(99, 99, 0));
  const auto every = [&](int n) {
    return faults_of(circling([&, n](Position& fix, int i) {
      if (i % n == 0) fix.position_world_m = default_m;
    }));
  };
  for (const int n : {3, 20}) {
    const auto faults = every(n);
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].kind == FixFaultKind::default_position);
    // The first fix of all has no neighbour before it.
    const int count = (167 + n - 1) / n - 1;
    CHECK_THAT(faults[0].text,
               Contains(std::to_string(count) + " of 167 fixes are ") && Contains("a default position"));
  }
  CHECK(every(60).empty());
}

SCENARIO("positions that are sent again are told from frozen ones") {
  Vector3d last_m = Vector3d::Zero();
  const auto again = faults_of(circling([&](Position& fix, int i) {
    if (i % 4 == 0) last_m = fix.position_world_m;
    fix.position_world_m = last_m;
  }));
  REQUIRE(again.size() == 1);
  CHECK(again[0].kind == FixFaultKind::repeated);
  CHECK(again[0].text == "125 of 167 fixes repeat the position of the one before, although the IMU moves");
  const auto frozen = faults_of(circling([&](Position& fix, int i) {
    if (i <= 30) last_m = fix.position_world_m;
    fix.position_world_m = last_m;
  }));
  REQUIRE(frozen.size() == 1);
  CHECK(frozen[0].kind == FixFaultKind::frozen);
}

SCENARIO("positions that a tag rounds are not taken for repetitions of a slow body") {
  const double resolution_m = GENERATE(0.05, 0.1, 0.2);
  const auto rounded = [=](const Vector3d& position_m) -> Vector3d {
    return resolution_m * (position_m / resolution_m).array().round();
  };
  CHECK(faults_of(circling([&](Position& fix, int) {
          fix.position_world_m = rounded(0.1 * fix.position_world_m);
        })).empty());
  Vector3d last_m = Vector3d::Zero();
  const auto again = faults_of(circling([&](Position& fix, int i) {
    if (i % 4 == 0) last_m = rounded(fix.position_world_m);
    fix.position_world_m = last_m;
  }));
  REQUIRE(again.size() == 1);
  CHECK(again[0].kind == FixFaultKind::repeated);
  const auto frozen = faults_of(circling([&](Position& fix, int i) {
    if (i < 60) last_m = rounded(0.4 * fix.position_world_m);
    fix.position_world_m = last_m;
  }));
  REQUIRE(frozen.size() == 1);
  CHECK(frozen[0].kind == FixFaultKind::frozen);
}

SCENARIO("a vehicle that stops and goes repeats no positions") {
  // Positions are equal while it stands. It stands for nine seconds of each twelve.
  Window window = circling([](Position&, int) {});
  const auto is_standing = [](TimeNs time_ns) { return time_ns % 12'000'000'000 > 3'000'000'000; };
  Vector3d last_m = Vector3d::Zero();
  for (Reading& reading : window.imu) {
    if (is_standing(reading.time_ns)) reading = {reading.time_ns, {0, 0, 0}, {0, 0, standard_gravity_mps2}};
  }
  for (Position& fix : window.fixes) {
    if (is_standing(fix.time_ns)) fix.position_world_m = last_m;
    last_m = fix.position_world_m;
  }
  CHECK(faults_of(window).empty());
}

SCENARIO("headings before a turn are right though they are small") {
  Window window = circling([](Position&, int) {});
  std::erase_if(window.headings, [](const Direction& heading) { return heading.time_ns > 3'000'000'000; });
  for (Direction& heading : window.headings) heading.heading_world_rad = 0.01;
  CHECK(faults_of(window).empty());
}

SCENARIO("headings in radians that are read as degrees are found") {
  Window window = circling([](Position&, int) {});
  window.heading_zero_rad = GENERATE(0.0, 1.6);  // those of a compass are turned by the mount of a pair
  for (Direction& heading : window.headings) {
    heading.heading_world_rad =
        heading.heading_world_rad * geometry::radians_per_degree + window.heading_zero_rad;
  }
  const auto faults = faults_of(window);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].kind == FixFaultKind::headings_in_radians);
}

SCENARIO("a heading that does not turn with the gyroscope is found, wherever it points") {
  const double value_rad = GENERATE(0.0, 2.1);
  Window window = circling([](Position&, int) {});
  for (Direction& heading : window.headings) heading.heading_world_rad = value_rad;
  const auto faults = faults_of(window);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].kind == FixFaultKind::headings_constant);
}

SCENARIO("coordinates that no unit explains are not taken for millimetres") {
  Window window = circling([](Position& fix, int) { fix.position_world_m = {1e308, 0, 0}; });
  for (const FixFault& fault : faults_of(window)) CHECK(fault.kind != FixFaultKind::unit);
}

}  // namespace fix_faults_test
