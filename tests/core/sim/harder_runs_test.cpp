/// Randomly drawn disturbances and sensors lie in their ranges and show in the runs.

#include "sim/simulator.hpp"
#include "support/events.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace harder_runs_test {

using namespace sonopose;
using namespace sonopose::sim;

constexpr TimeNs start_ns = Run{}.start_time_ns;
constexpr double per_deg = geometry::radians_per_degree;
constexpr double max_noise_m = 0.14;  ///< largest error of a fix with ordinary noise
constexpr std::uint64_t seeds = 100;

Scenario drawn_of(const char* name, std::uint64_t seed) {
  return drawn(find_scenario(name), {.seed = seed});
}

/// A run and the values drawn for it.
struct Drawn {
  Drawn(const char* name, std::uint64_t seed)
      : run{.seed = seed}, scenario{drawn(find_scenario(name), run)}, recording{record(scenario, run)} {}

  [[nodiscard]] Motion truth_at(TimeNs time_ns) const { return Simulator(scenario, run).motion_at(time_ns); }

  Run run;
  Scenario scenario;
  Recording recording;
};

double emitted_s(const UltrasonicFix& fix) {
  return seconds_between(start_ns, fix.emission_time_ns);
}

/// Smallest and largest of the added values.
struct Extent {
  double min = 1e9;
  double max = -1e9;

  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }

  /// True if all values are in the range and some are near each end.
  [[nodiscard]] bool spans(double from, double to) const {
    const double near = 0.1 * (to - from);
    return min >= from && min < from + near && max <= to && max > to - near;
  }
};

/// Outlier bursts active at this time.
std::vector<OutlierBurst> tracks_at(const Scenario& scenario, double time_s) {
  std::vector<OutlierBurst> found;
  for (const OutlierBurst& track : scenario.disturbances.outlier_bursts) {
    if (time_s >= track.begin_s && time_s < track.begin_s + track.duration_s) found.push_back(track);
  }
  return found;
}

SCENARIO("different seeds draw different runs") {
  CHECK(drawn_of("wrong_tracks", 1).disturbances.outlier_bursts.front().begin_s !=
        drawn_of("wrong_tracks", 2).disturbances.outlier_bursts.front().begin_s);
  CHECK(drawn_of("gyro_scale", 1).sensors.gyro_scale_error !=
        drawn_of("gyro_scale", 2).sensors.gyro_scale_error);
  CHECK(drawn_of("hand_held", 1).motion(20.0).position_world_m !=
        drawn_of("hand_held", 2).motion(20.0).position_world_m);
  CHECK(drawn_of("hand_held", 1).motion(20.0).position_world_m ==
        drawn_of("hand_held", 1).motion(20.0).position_world_m);
}

SCENARIO("wrong tracks are as many, as long and as far off as the scenario says") {
  Extent count;
  Extent fixes;
  Extent distance_m;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Scenario run = drawn_of("wrong_tracks", seed);
    count.add(static_cast<double>(run.disturbances.outlier_bursts.size()));
    for (const OutlierBurst& track : run.disturbances.outlier_bursts) {
      fixes.add(std::round(track.duration_s * run.sensors.fix_rate_hz.max));
      distance_m.add(track.offset_world_m.norm());
    }
  }
  CHECK(count.spans(9.0, 15.0));
  CHECK(fixes.spans(1.0, 30.0));
  CHECK(distance_m.spans(0.1, 3.0));
}

SCENARIO("the fixes of a run lie on its wrong tracks") {
  const Drawn drawn("wrong_tracks", 3);
  for (const UltrasonicFix& fix : test::samples_of<UltrasonicFix>(drawn.recording.events)) {
    Vector3d error_m = fix.position_world_m - drawn.truth_at(fix.emission_time_ns).position_world_m;
    for (const OutlierBurst& track : tracks_at(drawn.scenario, emitted_s(fix)))
      error_m -= track.offset_world_m;
    REQUIRE(error_m.norm() < max_noise_m);
  }
}

SCENARIO("a wrong track has as many fixes as were drawn") {
  const Drawn drawn("wrong_tracks", 3);
  const auto all = test::samples_of<UltrasonicFix>(drawn.recording.events);
  for (const OutlierBurst& track : drawn.scenario.disturbances.outlier_bursts) {
    const double end_s = track.begin_s + track.duration_s;
    if (end_s > 59.0) continue;  // cut off by the end of the run
    const auto on_track = std::count_if(all.begin(), all.end(), [&](const UltrasonicFix& fix) {
      return emitted_s(fix) >= track.begin_s && emitted_s(fix) < end_s;
    });
    const double drawn_fixes = track.duration_s * drawn.scenario.sensors.fix_rate_hz.max;
    CHECK(static_cast<double>(on_track) == Approx(drawn_fixes));
  }
}

SCENARIO("drifting tracks leave the true one slowly, mirrored ones mirror it") {
  int drifting = 0;
  int mirrored = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Drawn drawn("drifting_tracks", seed);
    for (const UltrasonicFix& fix : test::samples_of<UltrasonicFix>(drawn.recording.events)) {
      const auto tracks = tracks_at(drawn.scenario, emitted_s(fix));
      if (tracks.size() != 1) continue;
      const OutlierBurst& track = tracks.front();
      const Vector3d position_m = drawn.truth_at(fix.emission_time_ns).position_world_m;
      const double speed_mps = track.drift_world_mps.norm();
      if (speed_mps > 0.0) {
        ++drifting;
        REQUIRE(speed_mps >= 0.2);
        REQUIRE(speed_mps <= 1.0);
        const double expected_m = speed_mps * (emitted_s(fix) - track.begin_s);
        REQUIRE((fix.position_world_m - position_m).norm() == Approx(expected_m).margin(max_noise_m));
      }
      if (track.mirror) {
        ++mirrored;
        const Vector3d& wall_m = track.mirror->point_world_m;
        const Vector3d& normal = track.mirror->normal_world;
        const double true_m = normal.dot(position_m - wall_m);
        REQUIRE(normal.dot(fix.position_world_m - wall_m) == Approx(-true_m).margin(max_noise_m));
        REQUIRE(fix.position_world_m.z() == Approx(position_m.z()).margin(max_noise_m));
      }
    }
  }
  CHECK(drifting > 200);
  CHECK(mirrored > 50);
}

SCENARIO("the IMU has gaps, and the fixes continue in them") {
  Extent gap_s;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    for (const Outage& gap : drawn_of("imu_gaps", seed).disturbances.imu_outages) gap_s.add(gap.duration_s);
  }
  CHECK(gap_s.spans(0.2, 5.0));
  const Drawn drawn("imu_gaps", 2);
  double silent_s = 0;
  for (const Outage& gap : drawn.scenario.disturbances.imu_outages) {
    silent_s += std::min(gap.duration_s, drawn.scenario.duration_s - gap.begin_s);
  }
  const auto imu = test::samples_of<ImuSample>(drawn.recording.events);
  CHECK(static_cast<double>(imu.size()) == Approx(100.0 * (60.0 - silent_s)).margin(20.0));
  CHECK(drawn.recording.truth.size() == imu.size());
  const auto fixes = test::samples_of<UltrasonicFix>(drawn.recording.events);
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    REQUIRE(emitted_s(fixes[i]) - emitted_s(fixes[i - 1]) < 0.13);
  }
}

SCENARIO("a gyro with a scale error reads a share too much or too little") {
  Extent share;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    for (const double error : drawn_of("gyro_scale", seed).sensors.gyro_scale_error) share.add(error);
  }
  CHECK(share.spans(-0.01, 0.01));
  SensorSettings sensors = SensorSettings::ideal();
  sensors.gyro_scale_error = {0.01, -0.01, 0.005};
  ImuModel imu(sensors, Random(1));
  Motion motion;
  motion.angular_velocity_body_radps = {1.0, 2.0, 4.0};
  CHECK((imu.measure(motion).angular_velocity_body_radps - Vector3d(1.01, 1.98, 4.02)).norm() < 1e-12);
}

SCENARIO("the pair's heading is off for seconds, by up to 30 degrees") {
  Extent duration_s;
  Extent peak_deg;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    for (const HeadingError& error : drawn_of("magnetic_heading", seed).disturbances.heading_errors) {
      duration_s.add(error.duration_s);
      peak_deg.add(error.peak_rad / per_deg);
    }
  }
  CHECK(duration_s.spans(2.0, 10.0));
  CHECK(peak_deg.spans(-30.0, 30.0));
  const Drawn drawn("magnetic_heading", 1);
  int wrong = 0;
  for (const PairHeading& heading : test::samples_of<PairHeading>(drawn.recording.events)) {
    const Motion motion = drawn.truth_at(heading.emission_time_ns);
    const double error_rad =
        geometry::wrap_angle(heading.heading_world_rad - geometry::yaw_of(motion.q_body_to_world));
    const double time_s = seconds_between(start_ns, heading.emission_time_ns);
    const double drawn_rad = heading_error_rad(drawn.scenario.disturbances, time_s);
    REQUIRE(std::abs(error_rad - drawn_rad) < 4.0 * per_deg);
    if (std::abs(error_rad) > 5.0 * per_deg) ++wrong;
  }
  CHECK(wrong > 50);
}

SCENARIO("sparse fixes are sparse or noisy") {
  Extent rate_hz;
  Extent noise_m;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Drawn drawn("sparse_fixes", seed);
    const auto fixes = test::samples_of<UltrasonicFix>(drawn.recording.events);
    double squares = 0;
    for (const UltrasonicFix& fix : fixes) {
      squares += (fix.position_world_m - drawn.truth_at(fix.emission_time_ns).position_world_m).squaredNorm();
    }
    noise_m.add(std::sqrt(squares / 3.0 / static_cast<double>(fixes.size())));
    rate_hz.add(static_cast<double>(fixes.size() - 1) / (emitted_s(fixes.back()) - emitted_s(fixes.front())));
  }
  CHECK(rate_hz.spans(1.0 - 1e-6, 20.0 + 1e-6));
  CHECK(noise_m.min < 0.02);
  CHECK(noise_m.min > 0.008);
  CHECK(noise_m.max > 0.09);
  CHECK(noise_m.max < 0.12);
}

SCENARIO("the hall has gaps, spikes, poor fixes and half the fixes for half of the run") {
  Extent gap_s;
  int fixes = 0;
  int spikes = 0;
  int poor = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Drawn drawn("hall", seed);
    for (const Outage& gap : drawn.scenario.disturbances.outages) gap_s.add(gap.duration_s);
    REQUIRE(drawn.scenario.disturbances.halved_fix_rates.size() == 1);
    const HalvedFixRate& halved = drawn.scenario.disturbances.halved_fix_rates.front();
    CHECK(halved.duration_s == 30.0);
    int halved_fixes = 0;
    const auto all = test::samples_of<UltrasonicFix>(drawn.recording.events);
    for (const UltrasonicFix& fix : all) {
      const double error_m =
          (fix.position_world_m - drawn.truth_at(fix.emission_time_ns).position_world_m).norm();
      const bool reported = *fix.quality_percent <= 75.0;
      ++fixes;
      if (reported) ++poor;
      if (!reported && error_m > 0.2) ++spikes;
      if (!reported) REQUIRE(error_m < 3.0 + max_noise_m);
      const double time_s = emitted_s(fix);
      if (time_s >= halved.begin_s && time_s < halved.begin_s + halved.duration_s) ++halved_fixes;
    }
    const double share = halved_fixes / static_cast<double>(all.size());
    CHECK(share == Approx(1.0 / 3.0).margin(0.1));  // the gaps are not evenly distributed
  }
  CHECK(gap_s.spans(0.3, 3.0));
  CHECK(spikes / static_cast<double>(fixes) == Approx(0.03).margin(0.006));
  CHECK(poor / static_cast<double>(fixes) == Approx(0.45).margin(0.03));
}

SCENARIO("a moved map turns and shifts the truth once") {
  Extent turn_deg;
  Extent shift_m;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto moves = drawn_of("moved_map", seed).disturbances.relocations;
    REQUIRE(moves.size() == 1);
    turn_deg.add(moves.front().turn_rad / per_deg);
    shift_m.add(moves.front().by_world_m.norm());
  }
  CHECK(turn_deg.spans(-60.0, 60.0));
  CHECK(shift_m.spans(0.0, 3.0));
  GIVEN("a run, and the same without the move") {
    const Drawn moved("moved_map", 2);
    const Relocation& move = moved.scenario.disturbances.relocations.front();
    Scenario scenario = moved.scenario;
    scenario.disturbances = {};
    const Recording unmoved = record(scenario, moved.run);
    THEN("the truth is the same before, and turned by the angle afterwards") {
      for (std::size_t i = 0; i < unmoved.truth.size(); ++i) {
        const TruthSample& here = moved.recording.truth[i];
        const TruthSample& there = unmoved.truth[i];
        const bool before = seconds_between(start_ns, here.time_ns) < move.at_s;
        const double turn_rad =
            geometry::yaw_of(here.q_body_to_world) - geometry::yaw_of(there.q_body_to_world);
        const double expected_rad = before ? 0.0 : move.turn_rad;
        REQUIRE(std::abs(geometry::wrap_angle(turn_rad - expected_rad)) < 1e-9);
        REQUIRE(here.velocity_world_mps.norm() == Approx(there.velocity_world_mps.norm()).margin(1e-12));
        if (before) REQUIRE(here.position_world_m == there.position_world_m);
      }
    }
    THEN("the IMU does not feel it") {
      const auto imu = test::samples_of<ImuSample>(moved.recording.events);
      const auto other = test::samples_of<ImuSample>(unmoved.events);
      for (std::size_t i = 0; i < imu.size(); ++i) {
        REQUIRE((imu[i].specific_force_body_mps2 - other[i].specific_force_body_mps2).norm() < 0.02);
        REQUIRE(imu[i].angular_velocity_body_radps == other[i].angular_velocity_body_radps);
      }
    }
    THEN("fixes and headings are in the moved map") {
      for (const UltrasonicFix& fix : test::samples_of<UltrasonicFix>(moved.recording.events)) {
        const Motion truth = moved.truth_at(fix.emission_time_ns);
        REQUIRE((fix.position_world_m - truth.position_world_m).norm() < max_noise_m);
      }
      for (const PairHeading& heading : test::samples_of<PairHeading>(moved.recording.events)) {
        const double yaw_rad = geometry::yaw_of(moved.truth_at(heading.emission_time_ns).q_body_to_world);
        REQUIRE(std::abs(geometry::wrap_angle(heading.heading_world_rad - yaw_rad)) < 4.0 * per_deg);
      }
    }
  }
}

SCENARIO("any of the four beacons is misplaced, and the fixes are off with the place") {
  Extent error_m;
  std::array<int, 4> misplaced{};
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto drawn = drawn_of("misplaced_beacon", seed).disturbances.misplaced_beacon;
    REQUIRE(drawn);
    REQUIRE(drawn->beacons_world_m.size() == misplaced.size());
    CHECK(drawn->map_error_m.z() == 0.0);
    error_m.add(drawn->map_error_m.norm());
    ++misplaced.at(drawn->misplaced);
  }
  CHECK(error_m.spans(0.2, 0.6));
  for (const int count : misplaced) CHECK(count > 10);
  GIVEN("a run") {
    const Drawn drawn("misplaced_beacon", 1);
    THEN("each fix is off by what the map does to the ranges at its place") {
      Extent offset_m;
      for (const UltrasonicFix& fix : test::samples_of<UltrasonicFix>(drawn.recording.events)) {
        const Vector3d position_m = drawn.truth_at(fix.emission_time_ns).position_world_m;
        const Vector3d expected_m =
            track_offset_world_m(drawn.scenario.disturbances, emitted_s(fix), position_m);
        offset_m.add(expected_m.norm());
        REQUIRE((fix.position_world_m - position_m - expected_m).norm() < max_noise_m);
      }
      CHECK(offset_m.max - offset_m.min > 0.05);
    }
  }
}

SCENARIO("a wrong delay is reported, not real") {
  Extent error_s;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const double drawn_s = drawn_of("wrong_delay", seed).sensors.reported_delay_error_s;
    error_s.add(drawn_s);
  }
  CHECK(error_s.spans(-0.020, 0.020));
  const Drawn drawn("wrong_delay", 1);
  const double drawn_s = drawn.scenario.sensors.reported_delay_error_s;
  double reported_s = 0;
  const auto fixes = test::samples_of<UltrasonicFix>(drawn.recording.events);
  for (const UltrasonicFix& fix : fixes) {
    CHECK(seconds_between(fix.emission_time_ns, fix.received_time_ns) == Approx(*fix.measured_delay_s));
    reported_s += *fix.measured_delay_s / static_cast<double>(fixes.size());
    const TimeNs emission_ns = fix.emission_time_ns + to_ns(drawn_s);
    REQUIRE((fix.position_world_m - drawn.truth_at(emission_ns).position_world_m).norm() < max_noise_m);
  }
  CHECK(reported_s == Approx(0.068 + drawn_s).margin(0.001));
}

}  // namespace harder_runs_test
