/// The runs of a scenario have its disturbances and no others.

#include "sim/simulator.hpp"
#include "support/events.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace runs_test {

using namespace sonopose;
using namespace sonopose::sim;

constexpr TimeNs start_ns = Run{}.start_time_ns;

Recording run_of(const char* scenario, std::uint64_t seed = 1) {
  return record(find_scenario(scenario), {.seed = seed});
}

double emitted_s(const UltrasonicFix& fix) {
  return seconds_between(start_ns, fix.emission_time_ns);
}

/// Error of the fix against the tracked point's position on the scenario's path at the emission.
Vector3d error_m(const char* scenario, const UltrasonicFix& fix) {
  return fix.position_world_m - find_scenario(scenario).motion(emitted_s(fix)).position_world_m;
}

/// Root mean square per axis.
double per_axis(const std::vector<Vector3d>& values) {
  double sum = 0;
  for (const Vector3d& value : values) sum += value.squaredNorm() / 3.0;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double fix_rate_hz(const std::vector<UltrasonicFix>& fixes) {
  return static_cast<double>(fixes.size() - 1) /
         seconds_between(fixes.front().emission_time_ns, fixes.back().emission_time_ns);
}

SCENARIO("each run draws its fix rate and fix noise from the beacons' ranges") {
  GIVEN("forty seeds of the walk") {
    double min_hz = 1e9;
    double max_hz = 0;
    double min_m = 1e9;
    double max_m = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const auto fixes = test::samples_of<UltrasonicFix>(run_of("walk", seed).events);
      std::vector<Vector3d> errors;
      double delay_s = 0;
      for (const UltrasonicFix& fix : fixes) {
        errors.push_back(error_m("walk", fix));
        delay_s += *fix.measured_delay_s / static_cast<double>(fixes.size());
      }
      CHECK(delay_s == Approx(0.068).margin(0.001));
      min_hz = std::min(min_hz, fix_rate_hz(fixes));
      max_hz = std::max(max_hz, fix_rate_hz(fixes));
      min_m = std::min(min_m, per_axis(errors));
      max_m = std::max(max_m, per_axis(errors));
    }
    THEN("they spread over 8–16 Hz and 1.5–2.5 cm") {
      CHECK(min_hz >= 8.0);
      CHECK(min_hz < 9.0);
      CHECK(max_hz <= 16.0);
      CHECK(max_hz > 15.0);
      CHECK(min_m > 0.0142);  // the measured noise scatters by a few percent from run to run
      CHECK(min_m < 0.017);
      CHECK(max_m < 0.0262);
      CHECK(max_m > 0.023);
    }
  }
}

SCENARIO("fixes stop during an outage only") {
  const Recording recording = run_of("outages");
  const auto fixes = test::samples_of<UltrasonicFix>(recording.events);
  const double period_s = 1.0 / fix_rate_hz(test::samples_of<UltrasonicFix>(run_of("walk").events));
  std::vector<double> gaps_s;
  double sound_s = 1e9;  // shortest time between two outages
  double last_end_s = 0;
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    const double gap_s = emitted_s(fixes[i]) - emitted_s(fixes[i - 1]);
    if (gap_s < 1.5 * period_s) continue;
    gaps_s.push_back(gap_s);
    sound_s = std::min(sound_s, emitted_s(fixes[i - 1]) - last_end_s);
    last_end_s = emitted_s(fixes[i]);
  }
  THEN("there are silences of 2, 4 and 8 s, with ten seconds and more around them") {
    REQUIRE(gaps_s.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(gaps_s[i] == Approx(std::array{2.0, 4.0, 8.0}.at(i)).margin(2.0 * period_s));
    }
    CHECK(sound_s > 10.0);
    CHECK(emitted_s(fixes.back()) - last_end_s > 10.0);
  }
  THEN("there is no heading without its fix, and the IMU goes on") {
    CHECK(test::samples_of<PairHeading>(recording.events).size() == fixes.size());
    CHECK(test::samples_of<ImuSample>(recording.events).size() == 7500);
  }
}

SCENARIO("in an outlier burst the fixes lie on a parallel track") {
  const auto& bursts = find_scenario("outlier_bursts").disturbances.outlier_bursts;
  CHECK(bursts.size() >= 4);
  for (const OutlierBurst& burst : bursts) {
    CHECK(burst.duration_s >= 0.5);
    CHECK(burst.duration_s <= 2.0);
    CHECK(burst.offset_world_m.norm() >= 0.5);
    CHECK(burst.offset_world_m.norm() <= 1.5);
  }
  const Recording recording = run_of("outlier_bursts");
  std::map<std::size_t, std::vector<Vector3d>> error_by_burst_m;  // the last entry: outside all bursts
  for (const UltrasonicFix& fix : test::samples_of<UltrasonicFix>(recording.events)) {
    std::size_t i = 0;
    while (i < bursts.size() && !(emitted_s(fix) >= bursts[i].begin_s &&
                                  emitted_s(fix) < bursts[i].begin_s + bursts[i].duration_s)) {
      ++i;
    }
    Vector3d error = error_m("outlier_bursts", fix);
    if (i < bursts.size()) error -= bursts[i].offset_world_m;
    error_by_burst_m[i].push_back(error);
  }
  THEN("each burst has fixes, and beside the offset there is the usual noise alone") {
    REQUIRE(error_by_burst_m.size() == bursts.size() + 1);
    for (const auto& [burst, errors] : error_by_burst_m) {
      for (const Vector3d& error : errors) REQUIRE(error.norm() < 0.14);
    }
    CHECK(per_axis(error_by_burst_m[bursts.size()]) < 0.026);
  }
  THEN("the headings stay correct throughout") {
    for (const PairHeading& heading : test::samples_of<PairHeading>(recording.events)) {
      const Motion motion = find_scenario("walk").motion(seconds_between(start_ns, heading.emission_time_ns));
      const double yaw = geometry::yaw_of(motion.q_body_to_world);
      REQUIRE(std::abs(geometry::wrap_angle(heading.heading_world_rad - yaw)) < 0.08);
    }
  }
}

SCENARIO("fixes of low quality are worse, and report it") {
  std::vector<Vector3d> good;
  std::vector<Vector3d> moderate;
  std::vector<Vector3d> bad;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    for (const UltrasonicFix& fix : test::samples_of<UltrasonicFix>(run_of("low_quality", seed).events)) {
      const double quality = *fix.quality_percent;
      auto& kind = quality < 50.0 ? bad : quality <= 75.0 ? moderate : good;
      kind.push_back(error_m("low_quality", fix));
    }
  }
  const auto all = static_cast<double>(good.size() + moderate.size() + bad.size());
  CHECK(static_cast<double>(bad.size()) / all == Approx(0.25).margin(0.02));
  CHECK(static_cast<double>(moderate.size()) / all == Approx(0.20).margin(0.02));
  CHECK(per_axis(good) < 0.025);
  CHECK(per_axis(moderate) / per_axis(good) == Approx(2.0).epsilon(0.1));
  const double bad_m = std::sqrt(3.0) * per_axis(bad);
  CHECK(bad_m > 0.3);
  CHECK(bad_m < 0.5);
}

SCENARIO("a relocation moves the body at once without a trace in its IMU samples") {
  const Recording moved = run_of("relocation");
  Scenario scenario = find_scenario("relocation");
  REQUIRE(scenario.disturbances.relocations.size() == 1);
  const Relocation relocation = scenario.disturbances.relocations.front();
  scenario.disturbances = {};
  const Recording unmoved = record(scenario, {});
  THEN("the truth jumps once, by 2.5 m") {
    CHECK(relocation.by_world_m.norm() == Approx(2.5));
    int jumps = 0;
    for (std::size_t i = 1; i < moved.truth.size(); ++i) {
      const Vector3d step = moved.truth[i].position_world_m - moved.truth[i - 1].position_world_m;
      if (step.norm() < 0.01) continue;
      ++jumps;
      CHECK(step.norm() == Approx(2.5).margin(0.01));
      CHECK(seconds_between(start_ns, moved.truth[i].time_ns) == Approx(relocation.at_s).margin(0.011));
    }
    CHECK(jumps == 1);
  }
  THEN("the fixes jump with it, and the IMU's samples are the same to the bit") {
    const auto fixes = test::samples_of<UltrasonicFix>(moved.events);
    CHECK(error_m("relocation", fixes[fixes.size() / 4]).norm() < 0.14);
    CHECK((error_m("relocation", fixes.back()) - relocation.by_world_m).norm() < 0.14);
    CHECK(test::samples_of<ImuSample>(moved.events) == test::samples_of<ImuSample>(unmoved.events));
  }
}

SCENARIO("without a heading each seed starts in another direction") {
  const Scenario& scenario = find_scenario("no_heading");
  GIVEN("eight hundred seeds") {
    std::map<int, int> count_by_eighth;
    for (std::uint64_t seed = 1; seed <= 800; ++seed) {
      const double yaw =
          geometry::yaw_of(Simulator(scenario, {.seed = seed}).motion_at(start_ns).q_body_to_world);
      ++count_by_eighth[static_cast<int>(std::floor(yaw / (M_PI / 4)))];
    }
    THEN("the directions spread evenly over the circle") {
      REQUIRE(count_by_eighth.size() == 8);
      for (const auto& [eighth, count] : count_by_eighth) CHECK(count == Approx(100).margin(40));
    }
  }
  GIVEN("some runs") {
    THEN("each walks in its direction, and its fixes are there with it") {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Run run{.seed = seed, .duration_s = 30.0};
        const Recording recording = record(scenario, run);
        REQUIRE(test::samples_of<PairHeading>(recording.events).empty());
        // The body faces its course, whatever the initial yaw, and the fixes agree with the truth.
        const TruthSample& last = recording.truth.back();
        const double course = std::atan2(last.velocity_world_mps.y(), last.velocity_world_mps.x());
        CHECK(std::abs(geometry::wrap_angle(course - geometry::yaw_of(last.q_body_to_world))) < 1e-9);
        const auto fix = test::samples_of<UltrasonicFix>(recording.events).back();
        const Motion motion = Simulator(scenario, run).motion_at(fix.emission_time_ns);
        CHECK((motion.position_world_m - fix.position_world_m).norm() < 0.14);
      }
    }
  }
  CHECK(scenario.score_after_s == 20.0);
}

SCENARIO("the gyro's bias grows after the calibration") {
  GIVEN("the mean error of the gyro over twenty seeds, early and late") {
    Vector3d growth = Vector3d::Zero();
    constexpr int seeds = 20;
    const Scenario& scenario = find_scenario("gyro_bias");
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      Vector3d early = Vector3d::Zero();
      Vector3d late = Vector3d::Zero();
      for (const ImuSample& imu : test::samples_of<ImuSample>(run_of("gyro_bias", seed).events)) {
        const double t = seconds_between(start_ns, imu.sensor_time_ns);
        const Vector3d error =
            imu.angular_velocity_body_radps - scenario.motion(t).angular_velocity_body_radps;
        if (t < 3.0) early += error / 300.0;
        if (t >= 20.0 && t < 23.0) late += error / 300.0;
      }
      growth += (late - early) / seeds;
    }
    THEN("it has grown by about 1 deg/s") {
      CHECK(growth.norm() == Approx(1.0 * geometry::radians_per_degree).epsilon(0.1));
    }
  }
}

SCENARIO("with jitter the delay's mean stays and its spread grows") {
  std::vector<double> delays_s;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const auto& fix : test::samples_of<UltrasonicFix>(run_of("jitter", seed).events)) {
      delays_s.push_back(*fix.measured_delay_s);
    }
  }
  double mean_s = 0;
  for (const double delay_s : delays_s) mean_s += delay_s / static_cast<double>(delays_s.size());
  double variance = 0;
  for (const double delay_s : delays_s) {
    variance += (delay_s - mean_s) * (delay_s - mean_s) / static_cast<double>(delays_s.size());
  }
  CHECK(mean_s == Approx(0.068).margin(0.003));
  CHECK(std::sqrt(variance) == Approx(0.025).epsilon(0.1));
  CHECK(*std::min_element(delays_s.begin(), delays_s.end()) >= 0.001);
}

SCENARIO("a whole run is recorded in order") {
  GIVEN("a run without an end") {
    const Recording recording = run_of("outages");
    THEN("it ends with its scenario, and has the truth of each IMU sample") {
      const auto imu = test::samples_of<ImuSample>(recording.events);
      CHECK(seconds_between(start_ns, imu.back().sensor_time_ns) == Approx(74.99));
      REQUIRE(recording.truth.size() == imu.size());
      for (std::size_t i = 0; i < imu.size(); ++i) {
        REQUIRE(recording.truth[i].time_ns == imu[i].sensor_time_ns);
      }
    }
  }
  GIVEN("every scenario, twice") {
    THEN("a seed gives the same events again, another one others") {
      for (const auto& group : {scenarios(), harder_scenarios()}) {
        for (const Scenario& scenario : group) {
          CAPTURE(scenario.name);
          const Recording once = record(scenario, {.seed = 3});
          CHECK(once.events == record(scenario, {.seed = 3}).events);
          CHECK(once.events == record(drawn(scenario, {.seed = 3}), {.seed = 3}).events);
          CHECK(once.events != record(scenario, {.seed = 4}).events);
          for (std::size_t i = 0; i < once.events.size(); ++i) REQUIRE(sequence_of(once.events[i]) == i + 1);
        }
      }
    }
  }
}

}  // namespace runs_test
