#include "sim/hand_held.hpp"
#include "sim/paths.hpp"
#include "sim/scenario.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <numbers>
#include <vector>

namespace sonopose::sim {

namespace {

constexpr double first_disturbed_s = 5.0;

/// Draws spans with pauses between them until the end of the scenario.
template <typename Span>
std::vector<Span> draw_spans(const Scenario& scenario, Random& random, const Range& pause_s,
                             const Range& duration_s) {
  std::vector<Span> spans;
  double begin_s = first_disturbed_s;
  while (true) {
    begin_s += random.uniform_in(pause_s);
    if (begin_s >= scenario.duration_s) return spans;
    const double span_s = random.uniform_in(duration_s);
    spans.push_back({begin_s, span_s});
    begin_s += span_s;
  }
}

double draw_sign(Random& random) {
  return random.uniform() < 0.5 ? -1.0 : 1.0;
}

/// Draws about a dozen a minute.
int draw_track_count(const Scenario& scenario, Random& random) {
  return static_cast<int>(scenario.duration_s / 60.0 * random.integer_in(9, 15));
}

double draw_begin_s(const Scenario& scenario, Random& random) {
  return random.uniform_in({first_disturbed_s, scenario.duration_s});
}

/// Draws a wrong track of 1 to `max_fixes` fixes, parallel to the true one.
OutlierBurst draw_parallel_track(const Scenario& scenario, Random& random, double fix_rate_hz, int max_fixes,
                                 const Range& distance_m) {
  const double begin_s = draw_begin_s(scenario, random);
  const double duration_s = random.integer_in(1, max_fixes) / fix_rate_hz;
  const double off_m = random.uniform_in(distance_m);
  return {begin_s, duration_s, off_m * random.direction()};
}

OutlierBurst draw_parallel_track(const Scenario& scenario, Random& random, double fix_rate_hz) {
  return draw_parallel_track(scenario, random, fix_rate_hz, 30, {0.1, 3.0});
}

/// Draws the fix rate of the run, on which the length of a track depends.
double draw_fix_rate_hz(Scenario& scenario, Random& random) {
  const double rate_hz = random.uniform_in(scenario.sensors.fix_rate_hz);
  scenario.sensors.fix_rate_hz = rate_hz;
  return rate_hz;
}

void vary_wrong_tracks(Scenario& scenario, Random& random) {
  const double fix_rate_hz = draw_fix_rate_hz(scenario, random);
  const int count = draw_track_count(scenario, random);
  for (int i = 0; i < count; ++i) {
    scenario.disturbances.outlier_bursts.push_back(draw_parallel_track(scenario, random, fix_rate_hz));
  }
}

/// Draws a dozen short tracks a minute.
void vary_short_tracks(Scenario& scenario, Random& random) {
  const double fix_rate_hz = draw_fix_rate_hz(scenario, random);
  const int count = static_cast<int>(scenario.duration_s / 5.0);
  for (int i = 0; i < count; ++i) {
    scenario.disturbances.outlier_bursts.push_back(
        draw_parallel_track(scenario, random, fix_rate_hz, 10, {0.2, 1.5}));
  }
}

OutlierBurst draw_drifting_track(const Scenario& scenario, Random& random) {
  OutlierBurst track{draw_begin_s(scenario, random), random.uniform_in({1.0, 4.0})};
  const double speed_mps = random.uniform_in({0.2, 1.0});
  track.drift_world_mps = speed_mps * random.direction();
  return track;
}

/// Draws a track mirrored at a wall, which is near the tracked point when the track begins.
OutlierBurst draw_mirrored_track(const Scenario& scenario, Random& random) {
  OutlierBurst track{draw_begin_s(scenario, random), random.uniform_in({0.5, 3.0})};
  const double distance_m = random.uniform_in({0.2, 2.0});
  const Vector3d normal_world = random.horizontal_direction();
  const Vector3d point_world_m = scenario.motion(track.begin_s).position_world_m + distance_m * normal_world;
  track.mirror = Wall{point_world_m, normal_world};
  return track;
}

void vary_drifting_tracks(Scenario& scenario, Random& random) {
  const double fix_rate_hz = draw_fix_rate_hz(scenario, random);
  const int count = draw_track_count(scenario, random);
  for (int i = 0; i < count; ++i) {
    const double kind = random.uniform();
    scenario.disturbances.outlier_bursts.push_back(kind < 0.5 ? draw_drifting_track(scenario, random)
                                                   : kind < 0.75
                                                       ? draw_mirrored_track(scenario, random)
                                                       : draw_parallel_track(scenario, random, fix_rate_hz));
  }
}

/// Ratio of the largest to the mean acceleration in a smooth step of the speed.
constexpr double peak_of_ramp = 1.875;

/// Cuts the forklift's legs into pieces with hard stops between them.
void vary_hard_stops(Scenario& scenario, Random& random) {
  std::vector<Leg> lap;
  for (const Leg& whole : forklift_legs()) {
    const int pieces = random.integer_in(1, whole.length_m < 4.0 ? 2 : 3);
    std::vector<double> lengths_m;
    double sum_m = 0;
    for (int i = 0; i < pieces; ++i) sum_m += lengths_m.emplace_back(random.uniform_in({0.7, 1.3}));
    for (double& length_m : lengths_m) length_m *= whole.length_m / sum_m;
    for (const double length_m : lengths_m) {
      const double speed_mps = random.uniform_in({1.5, 2.5});
      const double ramp_s = peak_of_ramp * speed_mps / random.uniform_in({15.0, 20.0});
      lap.push_back({length_m, speed_mps, ramp_s, random.uniform_in({0.2, 3.0})});
    }
    lap.back().turn_rad = whole.turn_rad;
    lap.back().ready_s = random.uniform_in({0.2, 1.0});
  }
  scenario.path = [lap](double time_s) { return truck_path(lap, beacon_ahead_of_pivot_m, 1.5, time_s); };
}

void vary_imu_gaps(Scenario& scenario, Random& random) {
  scenario.disturbances.imu_outages = draw_spans<Outage>(scenario, random, {3.0, 10.0}, {0.2, 5.0});
}

void vary_gyro_scale(Scenario& scenario, Random& random) {
  for (double& error : scenario.sensors.gyro_scale_error) error = random.uniform_in({-0.01, 0.01});
}

void vary_magnetic_heading(Scenario& scenario, Random& random) {
  auto& errors = scenario.disturbances.heading_errors;
  errors = draw_spans<HeadingError>(scenario, random, {2.0, 8.0}, {2.0, 10.0});
  for (HeadingError& error : errors) {
    error.peak_rad = draw_sign(random) * random.uniform_in({5.0, 30.0}) * geometry::radians_per_degree;
  }
}

/// Starts the log somewhere on the way of a kart or a walk, at 1 m/s or more.
void vary_moving_start(Scenario& scenario, Random& random) {
  Path (*const path)(double time_s) = random.uniform() < 0.5 ? kart_path : walk_path;
  const double mount_yaw_rad = random.uniform_in({-std::numbers::pi, std::numbers::pi});
  double skipped_s = 0;
  double speed_mps = 0;
  while (speed_mps < 1.0 || speed_mps > 6.0) {
    skipped_s = random.uniform_in({departure_s, departure_s + 20.0});
    speed_mps = motion_on(path(skipped_s)).velocity_world_mps.norm();
  }
  scenario.path = [=](double time_s) {
    Path moving = path(skipped_s + time_s);
    moving.yaw = moving.yaw + mount_yaw_rad;
    return moving;
  };
}

/// Draws a closed course of six sides with five rolling corners and, on long sides, a stop.
std::vector<Leg> draw_hall_lap(Random& random) {
  constexpr double ramp_s = 1.2;
  constexpr double quarter_rad = std::numbers::pi / 2;
  const double long_m = random.uniform_in({12.0, 18.0});
  const double notch_m = random.uniform_in({4.5, 7.0});
  const double near_m = random.uniform_in({4.5, 8.0});
  const double far_m = random.uniform_in({4.5, 8.0});
  const auto leg = [&random](double length_m) {
    return Leg{.length_m = length_m, .speed_mps = random.uniform_in({2.0, 3.0}), .ramp_s = ramp_s};
  };
  std::vector<Leg> lap;
  const auto side = [&](double length_m, double turn_rad) {
    if (length_m >= 9.0 && random.uniform() < 0.7) {
      const double before_m = random.uniform_in({4.0, length_m - 4.0});
      lap.push_back(leg(before_m));
      lap.back().stop_s = random.uniform_in({0.5, 4.0});
      length_m -= before_m;
    }
    lap.push_back(leg(length_m));
    lap.back().turn_rad = turn_rad;
    lap.back().rolling = true;
  };
  side(long_m, quarter_rad);
  side(near_m, quarter_rad);
  side(notch_m, -quarter_rad);
  side(far_m, quarter_rad);
  side(long_m - notch_m, quarter_rad);
  side(near_m + far_m, quarter_rad);
  lap.back().rolling = false;
  lap.back().stop_s = random.uniform_in({0.5, 4.0});
  return lap;
}

void vary_hall(Scenario& scenario, Random& random) {
  constexpr double height_m = 1.0;
  scenario.path = [lap = draw_hall_lap(random)](double time_s) {
    return truck_path(lap, 0.0, height_m, time_s);
  };
  Disturbances& disturbances = scenario.disturbances;
  disturbances.outages = draw_spans<Outage>(scenario, random, {4.0, 12.0}, {0.3, 3.0});
  const double half_s = 0.5 * scenario.duration_s;
  disturbances.halved_fix_rates = {{random.uniform_in({0.0, half_s}), half_s}};
  disturbances.poor_fixes = poor_reception();
  disturbances.poor_fixes.push_back({.share = 0.03, .offset_m = {0.3, 3.0}});
}

void vary_hand_held(Scenario& scenario, Random& random) {
  scenario.path = [hand = draw_hand_motion(random)](double time_s) { return hand_held_path(hand, time_s); };
}

void vary_moved_map(Scenario& scenario, Random& random) {
  Relocation moved;
  moved.at_s = random.uniform_in({15.0, 40.0});
  const double shift_m = random.uniform_in({0.0, 3.0});
  moved.by_world_m = shift_m * random.horizontal_direction();
  moved.turn_rad = random.uniform_in({-60.0, 60.0}) * geometry::radians_per_degree;
  const double off_track_m = random.uniform_in({0.0, 3.0});
  moved.pivot_world_m =
      scenario.motion(moved.at_s).position_world_m + off_track_m * random.horizontal_direction();
  scenario.disturbances.relocations = {moved};
}

void vary_wrong_delay(Scenario& scenario, Random& random) {
  scenario.sensors.reported_delay_error_s = random.uniform_in({-0.020, 0.020});
}

/// Draws a misplaced beacon; only this scenario models the stationary beacons.
void vary_misplaced_beacon(Scenario& scenario, Random& random) {
  const std::vector<Vector3d> corners{{0, 0, 3}, {6, 0, 3}, {6, 4, 3}, {0, 4, 3}};
  const double error_m = random.uniform_in({0.2, 0.6});
  scenario.disturbances.misplaced_beacon = {.beacons_world_m = corners,
                                            .misplaced = static_cast<std::size_t>(random.integer_in(0, 3)),
                                            .map_error_m = error_m * random.horizontal_direction()};
}

SensorSettings sparse_and_noisy() {
  SensorSettings sensors;
  sensors.fix_rate_hz = {1.0, 20.0};
  sensors.fix_noise_m = {0.01, 0.10};
  return sensors;
}

std::vector<Scenario> make_harder_scenarios() {
  return {
      {.name = "wrong_tracks",
       .summary = "walks while the fixes jump to a dozen wrong tracks of 1 to 30 fixes, by 0.1 to 3 m",
       .path = walk_path,
       .vary = vary_wrong_tracks},
      {.name = "short_tracks",
       .summary = "walks while the fixes jump to a dozen wrong tracks of up to ten fixes, by 0.2 to 1.5 m",
       .path = walk_path,
       .vary = vary_short_tracks},
      {.name = "drifting_tracks",
       .summary = "walks while the fixes drift off the track at 0.2 to 1 m/s, are mirrored or jump",
       .path = walk_path,
       .vary = vary_drifting_tracks},
      {.name = "hard_stops",
       .summary = "drives as the forklift, but starts and stops at 15 to 20 m/s²",
       .path = forklift_path,
       .vary = vary_hard_stops},
      {.name = "imu_gaps",
       .summary = "walks, with gaps of the IMU of 0.2 to 5 s",
       .path = walk_path,
       .vary = vary_imu_gaps},
      {.name = "gyro_scale",
       .summary = "drives the kart's course with a gyro scale error of up to 1 % per axis",
       .path = kart_path,
       .vary = vary_gyro_scale},
      {.name = "magnetic_heading",
       .summary = "walks while the pair's heading is off by 5 to 30° for 2 to 10 s at a time",
       .path = walk_path,
       .vary = vary_magnetic_heading},
      {.name = "moving_start",
       .summary = "walks or drives the kart's course, already at 1 to 6 m/s when the log begins",
       .path = walk_path,
       .random_start_yaw = true,
       .vary = vary_moving_start},
      {.name = "sparse_fixes",
       .summary = "walks with 1 to 20 fixes per second and a noise of 1 to 10 cm",
       .path = walk_path,
       .sensors = sparse_and_noisy()},
      {.name = "hall",
       .summary = "drives round corners at 2 to 3 m/s with stops, gaps of 0.3 to 3 s, spikes and poor fixes",
       .path = forklift_path,
       .vary = vary_hall},
      {.name = "hand_held",
       .summary = "walks with a device in the hand that tilts by up to 60° and shakes",
       .path = walk_path,
       .vary = vary_hand_held},
      {.name = "moved_map",
       .summary = "walks while the map turns once by up to 60° and shifts by up to 3 m",
       .path = walk_path,
       .vary = vary_moved_map},
      {.name = "misplaced_beacon",
       .summary = "walks while the map has one of four stationary beacons 0.2 to 0.6 m off",
       .path = walk_path,
       .vary = vary_misplaced_beacon},
      {.name = "wrong_delay",
       .summary = "drives the kart's course while the reported delay is off by up to 20 ms",
       .path = kart_path,
       .vary = vary_wrong_delay},
  };
}

}  // namespace

std::span<const Scenario> harder_scenarios() {
  static const std::vector<Scenario> all = make_harder_scenarios();
  return all;
}

}  // namespace sonopose::sim
