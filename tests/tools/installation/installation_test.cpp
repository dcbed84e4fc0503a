#include "doctor/replayed.hpp"
#include "doctor/rules/checks.hpp"
#include "support/events.hpp"
#include "support/matches.hpp"
#include "support/seeds.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace installation_test {

using namespace sonopose;
using namespace sonopose::doctor::rules;
using namespace sonopose::doctor::test;
using Catch::Contains;
using sonopose::test::value_of;

double difference_deg(double a_deg, double b_deg) {
  return std::abs(std::remainder(a_deg - b_deg, 360.0));
}

TEST_CASE("A wrong mount offset is found, with the offset to try") {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> mounts_deg(-180, 180);
  std::uniform_real_distribution<double> begins_s(8, 20);
  for (const char* const scenario : {"walk", "forklift", "kart"}) {
    std::uint64_t seed = 1901;
    for (const double error_deg : {45.0, -90.0, 180.0}) {
      const double mount_deg = mounts_deg(random);
      const Look look{begins_s(random), 8};
      CAPTURE(scenario, seed, error_deg, mount_deg, look.begin_s);
      settings::Settings settings;
      settings.heading.mount_offset_deg = std::remainder(mount_deg + error_deg, 360.0);
      const auto events = events_of(scenario, seed++, 28.5, [&](sim::SensorSettings& sensors) {
        sensors.pair_mount_offset_rad = mount_deg * geometry::radians_per_degree;
      });
      const std::string problems = problems_of(observed(events, settings, look));
      CAPTURE(problems);
      CHECK_THAT(problems, Contains("its mount offset is wrong by about"));
      CHECK(difference_deg(value_of(problems, "heading.mount_offset_deg"), mount_deg) < 10);
      CHECK_THAT(problems, !Contains("-180"));
      CHECK_THAT(problems, !Contains("track"));  // consequences are not reported
    }
  }
}

TEST_CASE("A proposed value that rounds to zero has no sign") {
  // Wrong by 90 degrees and 0.1 s; right is 0.3 degrees and 0.1 ms below zero.
  BeaconObservation beacon;
  beacon.fusion_settings.heading.mount_offset_deg = 90;
  beacon.fusion_settings.delay.correction_s = 0.1;
  beacon.fix.samples = beacon.timed_fixes = 60;
  motion::fit::Piece piece;
  piece.fixes = 60;
  piece.length_s = 8;
  piece.span_m = 5;
  piece.residual_m = 0.02;
  piece.mount_rad =
      motion::fit::Measured{-0.3 * geometry::radians_per_degree, 0.5 * geometry::radians_per_degree};
  piece.mount_log_likelihood = 100;
  piece.delay_s = {-0.1001, 0.001};
  beacon.pieces = {piece};
  std::vector<Finding> findings;
  check_installation(beacon, findings);
  REQUIRE(findings.size() == 2);
  CHECK_THAT(findings[0].remedy, Contains("heading.mount_offset_deg=0,"));
  CHECK_THAT(findings[1].remedy, Contains("delay.correction_s=0.000;"));
}

TEST_CASE("A delay that is wrong by 40 ms is found while the beacon moves") {
  std::uint64_t seed = 1911;
  for (const char* const scenario : {"walk", "forklift", "kart"}) {
    for (const double error_s : {-0.04, 0.04}) {
      CAPTURE(scenario, seed, error_s);
      const auto events = events_of(scenario, seed++, 18.5, [&](sim::SensorSettings& sensors) {
        sensors.reported_delay_error_s = error_s;
      });
      const std::string problems = problems_of(observed(events, {}, {10, 8}));
      CAPTURE(problems);
      CHECK_THAT(problems,
                 Contains(error_s > 0 ? "younger than the fusion assumes" : "older than the fusion assumes"));
      CHECK(value_of(problems, "delay.correction_s") == Approx(-error_s).margin(0.015));
      settings::Settings settings;
      settings.delay.correction_s = -error_s;
      CHECK(problems_of(observed(events, settings, {10, 8})) == "");
    }
  }
}

TEST_CASE("An inverted axis of the accelerometer is found, and which one", "[accuracy]") {
  const bool all = sonopose::test::seeds(1, 2) == 2;  // otherwise each axis in one scenario
  std::uint64_t seed = 1921;
  for (const char* const scenario : {"walk", "forklift", "kart"}) {
    for (Eigen::Index axis = 0; axis < 3; ++axis, ++seed) {
      if (!all && seed != 1921U + 4 * static_cast<std::uint64_t>(axis)) continue;
      CAPTURE(scenario, seed, axis);
      auto events = events_of(scenario, seed, 18.5);
      invert_axis(events, axis);
      const std::string problems = problems_of(observed(events, {}, {10, 8}));
      CAPTURE(problems);
      CHECK_THAT(problems, Contains(std::string("the wrong sign on the body's axis ") + "xyz"[axis]));
      CHECK_THAT(problems, !Contains("mount offset is wrong"));
    }
  }
}

TEST_CASE("A gyroscope with the wrong sign is found where gravity shows the accelerometer to be right",
          "[accuracy]") {
  const bool all = sonopose::test::seeds(1, 2) == 2;  // otherwise one of two for each scenario
  std::uint64_t seed = 1940;
  for (const char* const scenario : {"walk", "kart", "forklift", "spin", "hall", "drone"}) {
    for (const bool all_axes : {false, true}) {
      ++seed;
      if (!all && seed % 4 > 1) continue;
      CAPTURE(scenario, seed, all_axes);
      auto events = events_of(scenario, seed, 18.5);
      for (auto* imu : sonopose::test::each<ImuSample>(events)) {
        Vector3d& rate = imu->angular_velocity_body_radps;
        rate = all_axes ? Vector3d(-rate) : Vector3d(rate.x(), rate.y(), -rate.z());
      }
      const std::string problems = problems_of(observed(events, {}, {10, 8}));
      CAPTURE(problems);
      CHECK_THAT(problems, Contains("its gyroscope has the wrong sign about the body's axis z"));
      CHECK_THAT(problems, !Contains("accelerometer") && !Contains("track") && !Contains("gyro bias") &&
                               !Contains("delay."));
    }
  }
}

TEST_CASE("Headings that are clockwise, as of a compass, are named beside the gyroscope") {
  for (const char* const scenario : {"walk", "kart", "forklift"}) {
    CAPTURE(scenario);
    auto events = events_of(scenario, 1948, 30);
    for (auto* heading : sonopose::test::each<PairHeading>(events)) heading->heading_world_rad *= -1;
    const std::string problems = problems_of(observed(events, {}, {10, 12}));
    CAPTURE(problems);
    CHECK_THAT(problems, Contains("or its headings are clockwise, as those of a compass"));
    CHECK_THAT(problems, !Contains("accelerometer") && !Contains("track"));
  }
}

TEST_CASE("Without headings, the direction of travel shows the sign of the gyroscope") {
  for (const char* const scenario : {"walk", "kart"}) {
    CAPTURE(scenario);
    const auto single = [](sim::SensorSettings& sensors) { sensors.pair_heading = false; };
    auto events = events_of(scenario, 1951, 18.5, single);
    for (auto* imu : sonopose::test::each<ImuSample>(events)) imu->angular_velocity_body_radps.z() *= -1;
    CHECK_THAT(problems_of(observed(events, {}, {10, 8})), Contains("its gyroscope has the wrong sign"));
  }
}

TEST_CASE("An accelerometer that reports gravity instead of specific force is named with all its axes") {
  std::uint64_t seed = 1961;
  for (const char* const scenario : {"walk", "forklift", "kart"}) {
    CAPTURE(scenario, seed);
    auto events = events_of(scenario, seed++, 18.5);
    for (Eigen::Index axis = 0; axis < 3; ++axis) invert_axis(events, axis);
    const std::string problems = problems_of(observed(events, {}, {10, 8}));
    CAPTURE(problems);
    CHECK_THAT(problems, Contains("its accelerometer has the wrong sign on all axes"));
    CHECK_THAT(problems, !Contains("axis z") && !Contains("mount offset"));
  }
}

TEST_CASE("Where the IMU may be turned by 90° in the beacon, the axes that correct it are named") {
  auto events = events_of("walk", 1971, 18.5);
  const Eigen::Matrix3d sensor_from_body =
      geometry::rotation_about_z(0.5 * std::numbers::pi).toRotationMatrix();
  for (auto* imu : sonopose::test::each<ImuSample>(events)) {
    imu->angular_velocity_body_radps = sensor_from_body * imu->angular_velocity_body_radps;
    imu->specific_force_body_mps2 = sensor_from_body * imu->specific_force_body_mps2;
  }
  const std::string problems = problems_of(observed(events, {}, {10, 8}));
  CAPTURE(problems);
  CHECK(difference_deg(value_of(problems, "heading.mount_offset_deg"), 90) < 10);
  CHECK_THAT(problems, Contains("calibration.axes=+y-x+z"));
  settings::Settings corrected;
  settings::set(corrected, "calibration.axes", settings::parse_value("calibration.axes", "+y-x+z"));
  CHECK(problems_of(observed(events, corrected, {10, 8})) == "");
}

}  // namespace installation_test
