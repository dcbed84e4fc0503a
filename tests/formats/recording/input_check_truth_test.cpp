/// Findings about recorded truth.

#include "recording/input_check.hpp"
#include "recording/standing_events.hpp"
#include "support/events.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace input_check_truth_test {

using namespace sonopose;
using namespace sonopose::recording;
using Catch::Contains;
using sonopose::test::standing;
using sonopose::test::start_ns;

SCENARIO("a truth in another unit of time, or of another clock, is found") {
  const std::vector<Event> events = standing();
  std::vector<TruthSample> truths(100);
  const TimeNs first_ns = available_at_ns(events.front());
  for (std::size_t i = 0; i < truths.size(); ++i)
    truths[i].time_ns = first_ns + 100'000'000 * static_cast<TimeNs>(i);
  CHECK(input_findings("log", events, nullptr, truths).empty());
  for (TruthSample& truth : truths) truth.time_ns /= 1000;
  const auto findings = input_findings("log", events, nullptr, truths);
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], Contains("most true poses are before the IMU samples"));
}

SCENARIO("a gyroscope of another clock than the truth is told from another order of the quaternion") {
  std::vector<Event> events = standing();
  const auto yaw_rad = [](TimeNs time_ns) {
    const double time_s = seconds_between(start_ns, time_ns);
    return 1.5 * std::sin(time_s) + 0.8 * std::sin(2.3 * time_s);
  };
  const auto rate_radps = [](TimeNs time_ns) {
    const double time_s = seconds_between(start_ns, time_ns);
    return 1.5 * std::cos(time_s) + 1.84 * std::cos(2.3 * time_s);
  };
  const double ahead_s = GENERATE(0.0, 0.8, 2.5, -1.2);
  for (auto* imu : test::each<ImuSample>(events)) {
    imu->angular_velocity_body_radps.z() += rate_radps(imu->sensor_time_ns - to_ns(ahead_s));
  }
  std::vector<TruthSample> truths(500);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    truths[i].time_ns = start_ns + 20'000'000 * static_cast<TimeNs>(i);
    truths[i].q_body_to_world = geometry::rotation_about_z(yaw_rad(truths[i].time_ns));
  }
  std::string all;
  for (const std::string& text : input_findings("log", events, nullptr, truths)) all += text;
  CAPTURE(ahead_s, all);
  if (ahead_s == 0.0) CHECK(all.empty());
  if (ahead_s == 0.8) CHECK_THAT(all, Contains("as the gyroscope does about 0.8 s later"));
  if (ahead_s == 2.5) CHECK_THAT(all, Contains("as the gyroscope does about 2.5 s later"));
  if (ahead_s == -1.2) CHECK_THAT(all, Contains("as the gyroscope does about 1.2 s before"));
  CHECK_THAT(all, !Contains("quaternion"));
}

SCENARIO("a truth of another frame, unit or order of the quaternion is found") {
  GIVEN("a circle of 2 m at 1 rad/s, and its truth at 50 Hz") {
    const auto at_m = [](TimeNs time_ns) {
      const double angle_rad = seconds_between(start_ns, time_ns);
      return Vector3d(5 + 2 * std::cos(angle_rad), 2 * std::sin(angle_rad), 0.5);
    };
    std::vector<Event> events = standing();
    for (Event& event : events) {
      if (auto* imu = std::get_if<ImuSample>(&event)) imu->angular_velocity_body_radps.z() += 1.0;
      if (auto* fix = std::get_if<UltrasonicFix>(&event)) fix->position_world_m = at_m(fix->emission_time_ns);
    }
    const auto finding_of = [&](const std::function<void(TruthSample&)>& change) {
      std::vector<TruthSample> truths;
      for (int i = 0; i < 500; ++i) {
        TruthSample truth;
        truth.time_ns = start_ns + i * 20'000'000LL;
        truth.position_world_m = at_m(truth.time_ns);
        const double angle_rad = seconds_between(start_ns, truth.time_ns);
        truth.q_body_to_world = geometry::rotation_about_z(angle_rad + 0.5 * std::numbers::pi);
        truth.velocity_world_mps = {-2 * std::sin(angle_rad), 2 * std::cos(angle_rad), 0};
        change(truth);
        truths.push_back(truth);
      }
      std::string all;
      for (const std::string& text : input_findings("log", events, nullptr, truths)) all += text;
      return all;
    };
    THEN("each is named, and a right one is not") {
      static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      CHECK(finding_of([](TruthSample&) {}).empty());
      CHECK(finding_of([](TruthSample& truth) {
              truth.velocity_world_mps.setConstant(unknown);
              truth.q_body_to_world.coeffs().setConstant(unknown);
            }).empty());
      CHECK_THAT(finding_of([](TruthSample& truth) { truth.position_world_m *= 1000; }),
                 Contains("or the true ones in mm?"));
      CHECK_THAT(finding_of([](TruthSample& truth) { truth.position_world_m.x() += 0.4; }),
                 Contains("usually 0.40 0.00 0.00 m from the fixes"));
      CHECK_THAT(finding_of([](TruthSample& truth) { truth.position_world_m.y() *= -1; }),
                 Contains("m from the fixes (median): are both in one frame?"));
      CHECK_THAT(
          finding_of([](TruthSample& truth) { truth.q_body_to_world = truth.q_body_to_world.conjugate(); }),
          Contains("turn otherwise than the gyroscope"));
      CHECK_THAT(finding_of([](TruthSample& truth) {
                   const auto [x, y, z, w] = std::array{truth.q_body_to_world.x(), truth.q_body_to_world.y(),
                                                        truth.q_body_to_world.z(), truth.q_body_to_world.w()};
                   truth.q_body_to_world = Quaterniond(z, w, x, y);
                 }),
                 Contains("is the order of the quaternion"));
      CHECK_THAT(finding_of([](TruthSample& truth) { truth.velocity_world_mps *= 3.6; }),
                 Contains("are they in km h^-1?"));
      CHECK_THAT(finding_of([](TruthSample& truth) {
                   truth.velocity_world_mps = truth.q_body_to_world.conjugate() * truth.velocity_world_mps;
                 }),
                 Contains("axes of the body?"));
    }
    THEN("an IMU that lies otherwise than the true poses is named with its axes") {
      for (auto* imu : test::each<ImuSample>(events)) {
        for (Vector3d* const vector : {&imu->angular_velocity_body_radps, &imu->specific_force_body_mps2}) {
          *vector = Vector3d(vector->x(), -vector->y(), -vector->z());
        }
      }
      CHECK_THAT(finding_of([](TruthSample&) {}),
                 Contains("with calibration.axes=+x-y-z") && !Contains("quaternion"));
    }
    THEN("another finding does not hide it, unless it is the cause") {
      for (auto* fix : test::each<UltrasonicFix>(events)) fix->quality_percent = 230;
      const auto mirrored = [](TruthSample& truth) { truth.position_world_m.y() *= -1; };
      CHECK_THAT(finding_of(mirrored), Contains("230 %") && Contains("are both in one frame?"));
      const auto conjugated = [](TruthSample& truth) {
        truth.q_body_to_world = truth.q_body_to_world.conjugate();
        truth.velocity_world_mps *= 3.6;
      };
      CHECK_THAT(finding_of(conjugated), Contains("than the gyroscope") && Contains("km h^-1"));
      for (auto* fix : test::each<UltrasonicFix>(events)) {
        fix->emission_time_ns += 3'000'000'000;
        fix->received_time_ns += 3'000'000'000;
      }
      CHECK_THAT(finding_of([](TruthSample&) {}),
                 Contains("after the IMU samples") && !Contains("true positions"));
    }
  }
}

}  // namespace input_check_truth_test
