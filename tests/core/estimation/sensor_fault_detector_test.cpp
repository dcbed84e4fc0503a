/// Faults of the IMU that are seen beside the engine, and how soon.

#include "sim/simulator.hpp"
#include "support/seeds.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/sensor_fault_detector.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace sensor_fault_detector_test {

using namespace sonopose;

using Change = std::function<void(ImuSample&)>;

/// Seconds from the begin of the motion, at 3 s, to the first pose with one of the bits by the detector, or
/// of `engine_bits` by the engine; infinite without one.
double found_after_s(const std::string& scenario, std::uint64_t seed, bool has_headings, const Change& change,
                     std::uint32_t bits = ~0U, double mount_rad = 0, std::uint32_t engine_bits = 0) {
  constexpr double begin_s = 3.0;
  const sim::Run run{.seed = seed, .duration_s = 32.0};
  sim::Scenario drawn = sim::drawn(sim::find_scenario(scenario), run);
  drawn.sensors.pair_heading = drawn.sensors.pair_heading && has_headings;
  drawn.sensors.pair_mount_offset_rad += mount_rad;
  const std::vector<Event> events = sim::record(drawn, run).events;
  const settings::Settings settings;
  estimation::AnyEstimator estimator(settings);
  estimation::SensorFaultDetector detector(settings);
  const TimeNs begin_ns = available_at_ns(events.front()) + to_ns(begin_s);
  for (Event event : events) {
    auto* const imu = std::get_if<ImuSample>(&event);
    if (imu != nullptr) change(*imu);
    detector.on(event);
    const auto result = estimation::process(estimator, event);
    const auto* const pose = std::get_if<FusedPose>(&result);
    if (pose == nullptr) continue;
    detector.on(*pose);
    if ((detector.status(pose->time_ns) & bits) != 0 || (pose->status & engine_bits) != 0)
      return seconds_between(begin_ns, pose->time_ns);
  }
  return std::numeric_limits<double>::infinity();
}

TEST_CASE("a right IMU is never taken for a wrong one") {
  std::vector<sim::Scenario> scenarios(sim::scenarios().begin(), sim::scenarios().end());
  scenarios.insert(scenarios.end(), sim::harder_scenarios().begin(), sim::harder_scenarios().end());
  for (const sim::Scenario& scenario : scenarios) {
    for (std::uint64_t seed = 1; seed <= test::seeds(1, 10); ++seed) {
      for (const bool has_headings : {true, false}) {
        CAPTURE(scenario.name, seed, has_headings);
        CHECK(found_after_s(std::string(scenario.name), seed, has_headings, [](ImuSample&) {}) > 30.0);
      }
    }
  }
}

/// The same for two tags, 1 m ahead and behind, of which each sends `in_row` fixes at a time.
double found_between_tags_after_s(const char* scenario, bool has_headings, int in_row,
                                  double yaw_rate_factor) {
  constexpr double begin_s = 3.0;
  const sim::Run run{.seed = 3, .duration_s = 32.0};
  sim::Scenario drawn = sim::drawn(sim::find_scenario(scenario), run);
  drawn.sensors.pair_heading = drawn.sensors.pair_heading && has_headings;
  const sim::Recording recording = sim::record(drawn, run);
  const settings::Settings settings;
  estimation::AnyEstimator estimator(settings);
  estimation::SensorFaultDetector detector(settings);
  int fixes = 0;
  for (Event event : recording.events) {
    if (auto* const fix = std::get_if<UltrasonicFix>(&event)) {
      const auto truth =
          std::ranges::lower_bound(recording.truth, fix->emission_time_ns, {}, &TruthSample::time_ns);
      fix->point_body_m = {++fixes / in_row % 2 == 0 ? 1.0 : -1.0, 0.4, 0};
      if (truth != recording.truth.end()) fix->position_world_m += truth->q_body_to_world * fix->point_body_m;
    } else if (auto* const imu = std::get_if<ImuSample>(&event)) {
      imu->angular_velocity_body_radps.z() *= yaw_rate_factor;
    }
    detector.on(event);
    const auto result = estimation::process(estimator, event);
    const auto* const pose = std::get_if<FusedPose>(&result);
    if (pose == nullptr) continue;
    detector.on(*pose);
    if (detector.status(pose->time_ns) != 0)
      return seconds_between(recording.truth.front().time_ns, pose->time_ns) - begin_s;
  }
  return std::numeric_limits<double>::infinity();
}

TEST_CASE("a right IMU is not taken for a wrong one between tags that alternate") {
  for (const char* const scenario : {"walk", "kart", "forklift"}) {
    for (const bool has_headings : {true, false}) {
      CAPTURE(scenario, has_headings);
      CHECK(found_between_tags_after_s(scenario, has_headings, 2, 1.0) > 30.0);
      CHECK(found_between_tags_after_s(scenario, has_headings, 5, 1.0) > 30.0);
    }
  }
}

TEST_CASE("a gyroscope of the wrong sign is found between tags that alternate too") {
  for (const char* const scenario : {"walk", "kart"}) {
    CAPTURE(scenario);
    CHECK(found_between_tags_after_s(scenario, false, 1, -1.0) < 7.0);
    CHECK(found_between_tags_after_s(scenario, false, 2, -1.0) < 7.0);
  }
}

TEST_CASE("a pair that is mounted across is found, also where the engine does not follow its headings") {
  for (const char* const scenario : {"walk", "kart", "forklift"}) {
    for (const double mount_rad : {0.5 * std::numbers::pi, -0.5 * std::numbers::pi, std::numbers::pi}) {
      CAPTURE(scenario, mount_rad);
      CHECK(found_after_s(
                scenario, 5, true, [](ImuSample&) {}, status_imu_inconsistent, mount_rad) < 20.0);
    }
  }
}

TEST_CASE("an axis that keeps its value is found within three seconds") {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    CHECK(found_after_s("walk", 3, true,
                        [axis](ImuSample& imu) { imu.specific_force_body_mps2(axis) = 0.5; }) < 3.0);
    CHECK(found_after_s("walk", 3, true,
                        [axis](ImuSample& imu) { imu.angular_velocity_body_radps(axis) = 0.0; }) < 3.0);
  }
}

TEST_CASE("a fault ends with its cause, and with a clock that is set back") {
  estimation::SensorFaultDetector detector{settings::Settings{}};
  TimeNs time_ns = 1'700'000'000'000'000'000;
  const auto feed = [&](int samples, double noise) {
    for (int i = 0; i < samples; ++i, time_ns += 10'000'000) {
      ImuSample imu;
      imu.sensor_time_ns = time_ns;
      imu.specific_force_body_mps2 = {i % 7 * noise, i % 5 * 1e-3, standard_gravity_mps2};
      imu.angular_velocity_body_radps = {i % 7 * 1e-3, i % 5 * 1e-3, i % 3 * 1e-3};
      detector.on(imu);
    }
    return detector.status(time_ns);
  };
  CHECK(feed(300, 1e-3) != 0);  // z of the accelerometer keeps its value
  time_ns -= 3'600'000'000'000;
  CHECK(feed(1, 1e-3) == 0);
}

/// Seconds until a fault of an IMU at the end of an arm that swings for 20 s; infinite without one.
double found_on_swinging_arm_after_s(double force_factor) {
  constexpr double arm_m = 0.65;
  constexpr double amplitude_rad = 1.0;
  constexpr double omega_radps = 2.0 * std::numbers::pi * 1.2;
  constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
  estimation::SensorFaultDetector detector{settings::Settings{}};
  double force_sum_mps2 = 0;
  int samples = 0;
  for (double time_s = 0; time_s < 20.0; time_s += 0.01) {
    const double pitch_rad = amplitude_rad * std::sin(omega_radps * time_s);
    const double rate_radps = omega_radps * amplitude_rad * std::cos(omega_radps * time_s);
    const double angular_acceleration_radps2 = -omega_radps * omega_radps * pitch_rad;
    ImuSample imu;
    imu.sensor_time_ns = begin_ns + to_ns(time_s);
    imu.angular_velocity_body_radps = Vector3d(0, rate_radps, 0);
    // It hangs from the pivot along -z: the centripetal acceleration is along +z. Gravity turns with the
    // body, and the free axis has noise.
    const Vector3d force_mps2(
        -arm_m * angular_acceleration_radps2 - standard_gravity_mps2 * std::sin(pitch_rad),
        0.02 * std::sin(700.0 * time_s),
        arm_m * rate_radps * rate_radps + standard_gravity_mps2 * std::cos(pitch_rad));
    imu.specific_force_body_mps2 = force_factor * force_mps2;
    force_sum_mps2 += force_mps2.norm();
    ++samples;
    detector.on(Event(imu));
    if (detector.status(imu.sensor_time_ns) != 0) return time_s;
  }
  CHECK(force_sum_mps2 / samples > 19.0);  // about twice gravity
  return std::numeric_limits<double>::infinity();
}

TEST_CASE("the forces at the end of a swinging arm are no wrong unit, but thrice these are") {
  CHECK(found_on_swinging_arm_after_s(1.0) > 20.0);
  CHECK(found_on_swinging_arm_after_s(3.0) < 5.0);
}

TEST_CASE("a unit that contradicts gravity is found within four seconds") {
  for (const double unit : {1.0 / standard_gravity_mps2, 3.28}) {
    CAPTURE(unit);
    CHECK(found_after_s("walk", 3, true, [unit](ImuSample& imu) { imu.specific_force_body_mps2 *= unit; }) <
          4.0);
  }
}

TEST_CASE("a gyroscope of the wrong sign is found within seconds of turning, with and without headings") {
  const auto inverted = [](ImuSample& imu) { imu.angular_velocity_body_radps.z() *= -1.0; };
  for (const bool has_headings : {true, false}) {
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
      CAPTURE(has_headings, seed);
      CHECK(found_after_s("walk", seed, has_headings, inverted) < 5.0);
      CHECK(found_after_s("kart", seed, has_headings, inverted) < 6.5);  // straight for 3.5 s
    }
  }
}

TEST_CASE("stamps of the IMU that are ahead are found while it turns") {
  for (const char* const scenario : {"walk", "kart", "forklift"}) {
    for (const TimeNs ahead_ns : {300'000'000, 400'000'000}) {
      CAPTURE(scenario, ahead_ns);
      CHECK(found_after_s(
                scenario, 3, true, [ahead_ns](ImuSample& imu) { imu.sensor_time_ns += ahead_ns; },
                status_fixes_inconsistent) < 12.0);
    }
  }
}

TEST_CASE("a mount that is turned by 90 degrees is found within four seconds of motion") {
  for (const char* const scenario : {"walk", "kart", "forklift"}) {
    for (const double angle_deg : {90.0, -90.0, 180.0}) {
      CAPTURE(scenario, angle_deg);
      const Eigen::Matrix3d turned =
          geometry::rotation_about_z(angle_deg * std::numbers::pi / 180.0).toRotationMatrix();
      const auto turn = [&turned](ImuSample& imu) {
        imu.angular_velocity_body_radps = turned * imu.angular_velocity_body_radps;
        imu.specific_force_body_mps2 = turned * imu.specific_force_body_mps2;
      };
      // Where the engine distrusts the IMU first, its poses show the detector no accelerations to compare.
      CHECK(found_after_s(scenario, 3, true, turn, ~0U, 0, status_imu_inconsistent) < 4.0);
    }
  }
}

}  // namespace sensor_fault_detector_test
