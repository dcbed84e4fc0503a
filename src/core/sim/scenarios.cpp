#include "sim/paths.hpp"
#include "sim/scenario.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::sim {

namespace {

/// The pair's centre is on the axis of rotation, the IMU next to it.
SensorSettings imu_off_the_axis() {
  SensorSettings sensors;
  sensors.imu_from_tracked_point_body_m = {0.06, 0.0, 0.0};
  return sensors;
}

SensorSettings single_beacon() {
  SensorSettings sensors;
  sensors.pair_heading = false;
  return sensors;
}

SensorSettings poor_gyro() {
  SensorSettings sensors;
  sensors.gyro_bias_radps = 1.0 * geometry::radians_per_degree;
  sensors.gyro_bias_walk_radps_rts = 0.0005;
  return sensors;
}

SensorSettings uneven_delay() {
  SensorSettings sensors;
  sensors.fix_delay_jitter_s = 0.025;
  return sensors;
}

Disturbances wrong_tracks() {
  return {.outlier_bursts = {{12.0, 1.0, {0.9, 0.5, 0.0}},
                             {20.0, 0.5, {-0.4, 0.3, 0.0}},
                             {28.0, 2.0, {0.0, -0.8, 0.2}},
                             {38.0, 1.5, {-1.2, 0.8, -0.2}},
                             {47.0, 0.7, {0.6, 0.1, 0.1}},
                             {54.0, 1.2, {0.3, 1.0, 0.0}}}};
}

Disturbances silences() {
  return {.outages = {{15.0, 2.0}, {30.0, 4.0}, {48.0, 8.0}}};
}

/// Carried away by 2.5 m.
Disturbances carried_away() {
  return {.relocations = {{25.0, {2.0, 1.5, 0.0}}}};
}

/// Drift by 1 deg/s in total, after any calibration at the start.
Disturbances warming_up() {
  const Vector3d by_deg_per_s{0.5, -0.5, 0.7};
  return {.gyro_drift = GyroDrift{8.0, 10.0, geometry::radians_per_degree * by_deg_per_s}};
}

Disturbances bad_line() {
  return {.imu_packets = {.dropped_share = 0.01,
                          .lost_runs_share = 0.001,
                          .duplicated_share = 0.01,
                          .late_share = 0.01,
                          .late_by_s = {0.005, 0.045}},
          .position_packets = {.dropped_share = 0.10,
                               .lost_runs_share = 0.005,
                               .duplicated_share = 0.05,
                               .late_share = 0.05,
                               .late_by_s = {0.05, 0.30}}};
}

std::vector<Scenario> make_scenarios() {
  return {
      {.name = "rest", .summary = "stands still, level", .path = rest_path},
      {.name = "walk",
       .summary = "walks a figure of eight of 4 m × 2 m at 0.6 to 1.3 m/s",
       .path = walk_path},
      {.name = "circle", .summary = "drives a circle of 8 m radius at 6 m/s", .path = circle_path},
      {.name = "forklift",
       .summary = "drives at up to 2 m/s, stops for up to 2 s, makes quarter turns at 1.8 rad/s",
       .path = forklift_path},
      {.name = "kart",
       .summary = "drives a figure of eight of 28 m × 9 m at 4.6 to 6.1 m/s, up to 6.1 m/s² sideways",
       .path = kart_path},
      {.name = "spin",
       .summary = "turns about the tracked point at 9 rad/s both ways, the IMU 6 cm off it",
       .path = spin_path,
       .sensors = imu_off_the_axis()},
      {.name = "drone",
       .summary = "flies in three dimensions at up to 2 m/s and tilts by up to 12°",
       .path = drone_path},
      {.name = "outlier_bursts",
       .summary = "walks while the fixes jump to a wrong track six times, for 0.5 to 2 s, by 0.5 to 1.5 m",
       .path = walk_path,
       .disturbances = wrong_tracks()},
      {.name = "outages",
       .summary = "walks, with outages of the fixes of 2, 4 and 8 s",
       .path = walk_path,
       .disturbances = silences(),
       .duration_s = 75},
      {.name = "low_quality",
       .summary = "walks while a quarter of the fixes has 12 times the noise, and a fifth has twice",
       .path = walk_path,
       .disturbances = {.poor_fixes = poor_reception()}},
      {.name = "relocation",
       .summary = "walks slowly and is relocated by 2.5 m after 25 s",
       .path = stroll_path,
       .disturbances = carried_away()},
      {.name = "no_heading",
       .summary = "walks with a single beacon from an unknown direction",
       .path = walk_path,
       .sensors = single_beacon(),
       .random_start_yaw = true,
       .score_after_s = 20},
      {.name = "gyro_bias",
       .summary = "walks while the gyro's bias grows by 1 deg/s from 8 to 18 s",
       .path = walk_path,
       .sensors = poor_gyro(),
       .disturbances = warming_up()},
      {.name = "jitter",
       .summary = "walks while the fixes' delay of 68 ms varies by 25 ms",
       .path = walk_path,
       .sensors = uneven_delay()},
      {.name = "packet_loss",
       .summary = "walks while packets are lost, duplicated and delayed",
       .path = walk_path,
       .disturbances = bad_line()},
  };
}

}  // namespace

std::span<const Scenario> scenarios() {
  static const std::vector<Scenario> all = make_scenarios();
  return all;
}

const Scenario& find_scenario(std::string_view name) {
  std::string known;
  for (const auto& group : {scenarios(), harder_scenarios(), violations()}) {
    for (const Scenario& scenario : group) {
      if (scenario.name == name) return scenario;
      known += known.empty() ? "" : ", ";
      known += scenario.name;
    }
  }
  throw std::invalid_argument("unknown scenario \"" + std::string(name) + "\"; known are " + known);
}

}  // namespace sonopose::sim
