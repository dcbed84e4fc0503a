// Scenarios whose sensors violate what an estimator assumes of them.

#include "sim/paths.hpp"
#include "sim/scenario.hpp"
#include "sim/taylor.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace sonopose::sim {

namespace {

constexpr double per_deg = geometry::radians_per_degree;
constexpr double without_end_s = 1e6;

Vector3d drawn_factors(Random& random, const Range& range) {
  return {random.uniform_in(range), random.uniform_in(range), random.uniform_in(range)};
}

/// Draws a walk in most runs, otherwise the forklift's or the kart's way.
auto draw_path(Random& random) -> Path (*)(double) {
  const double kind = random.uniform();
  return kind < 0.5 ? walk_path : kind < 0.75 ? forklift_path : kart_path;
}

void vary_accel_bias_steps(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  double time_s = random.uniform_in({8.0, 15.0});
  while (time_s < scenario.duration_s) {
    const double step_mps2 = random.uniform_in({0.1, 0.3});
    const double held_s = random.uniform_in({3.0, 15.0});
    scenario.disturbances.imu_faults.push_back(
        {.begin_s = time_s, .duration_s = held_s, .accel_offset_body_mps2 = step_mps2 * random.direction()});
    time_s += held_s + random.uniform_in({3.0, 12.0});
  }
}

void vary_warming_up(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  const double begin_s = random.uniform_in({8.0, 20.0});
  const double rate_radps = random.uniform_in({0.3, 0.8}) * per_deg;
  const double step_mps2 = random.uniform_in({0.2, 0.35});
  scenario.disturbances.gyro_drift = {
      .begin_s = begin_s, .duration_s = 20.0, .by_body_radps = rate_radps * random.direction()};
  scenario.disturbances.imu_faults.push_back({.begin_s = begin_s,
                                              .duration_s = without_end_s,
                                              .accel_offset_body_mps2 = step_mps2 * random.direction()});
}

/// Adds blows from below that the truth does not contain, mostly vertical.
void add_shocks(Scenario& scenario, Random& random, double mean_pause_s, const Range& accel_mps2,
                const Range& duration_s) {
  double time_s = 6.0;
  while (true) {
    time_s += random.uniform_in({0.3 * mean_pause_s, 1.7 * mean_pause_s});
    if (time_s > scenario.duration_s) return;
    const Vector3d direction = (random.direction() + Vector3d(0.0, 0.0, 1.5)).normalized();
    scenario.disturbances.imu_faults.push_back(
        {.begin_s = time_s,
         .duration_s = random.uniform_in(duration_s),
         .accel_offset_body_mps2 = random.uniform_in(accel_mps2) * direction});
  }
}

void vary_door_sills(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  add_shocks(scenario, random, 4.5, {5.0, 12.0}, {0.02, 0.04});
}

void vary_clipped_kerbs(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  scenario.sensors.accel_limit_mps2 = 4.0 * standard_gravity_mps2;
  scenario.disturbances.imu_faults.push_back(
      {.begin_s = departure_s, .duration_s = without_end_s, .vibration_mps2 = random.uniform_in({0.5, 3.0})});
  add_shocks(scenario, random, 6.0, {20.0, 45.0}, {0.02, 0.04});
}

/// Draws a body that walks to its place and then stands, swaying slowly.
void vary_swaying(Scenario& scenario, Random& random) {
  const double stands_s = random.uniform_in({10.0, 20.0});
  struct SwayComponent {
    double amplitude_rad;
    double rate_radps;
    double phase_rad;
  };
  std::array<SwayComponent, 2> components{};
  for (SwayComponent& component : components) {
    component = {random.uniform_in({0.2, 0.7}) * per_deg,
                 2.0 * std::numbers::pi * random.uniform_in({0.1, 0.4}),
                 random.uniform_in({-std::numbers::pi, std::numbers::pi})};
  }
  const double height_m = random.uniform_in({0.5, 1.6});
  scenario.path = [=](double time_s) {
    constexpr double braking_s = 1.5;
    // Time along the walk stops after `stands_s`.
    const Jet left = smooth_start({(stands_s - time_s) / braking_s + 1.0, -1.0 / braking_s, 0.0});
    const double walked_s = stands_s + 0.5 * braking_s - braking_s * left.value;
    Path path = walk_path(walked_s);
    const double speed = -braking_s * left.rate;
    const double acceleration = -braking_s * left.acceleration;
    for (Jet* jet : {&path.x, &path.y, &path.z, &path.yaw, &path.pitch, &path.roll}) {
      *jet = {jet->value, jet->rate * speed, jet->acceleration * speed * speed + jet->rate * acceleration};
    }
    const Jet begun = smooth_step({(time_s - stands_s - braking_s) / 3.0, 1.0 / 3.0, 0.0});
    const auto sway_angle = [&](const SwayComponent& component) {
      return begun * sine(component.amplitude_rad, component.rate_radps, component.phase_rad, time_s).jet();
    };
    const Jet pitch = sway_angle(components[0]);
    const Jet roll = sway_angle(components[1]);
    path.pitch = path.pitch + pitch;
    path.roll = path.roll + roll;
    const double cos_yaw = std::cos(path.yaw.value);  // constant while it leans
    const double sin_yaw = std::sin(path.yaw.value);
    path.x = path.x + Jet{height_m} * (Jet{cos_yaw} * pitch + Jet{sin_yaw} * roll);
    path.y = path.y + Jet{height_m} * (Jet{sin_yaw} * pitch - Jet{cos_yaw} * roll);
    return path;
  };
}

void vary_flat_beacons(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  scenario.sensors.fix_noise_m = 0.02;
  scenario.sensors.fix_noise_factor.z() = random.uniform_in({15.0, 25.0});
}

void vary_default_positions(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  const double kind = random.uniform();
  const Vector3d place = kind < 0.6 ? Vector3d::Zero() : Vector3d(0.0, 0.0, random.uniform_in({1.0, 3.0}));
  scenario.disturbances.poor_fixes = {{.share = random.uniform_in({0.2, 0.42}), .default_world_m = place}};
}

/// Draws when a fault begins: at the start, or some seconds later.
double draw_fault_begin_s(Random& random) {
  return random.uniform() < 0.4 ? 0.0 : random.uniform_in({8.0, 30.0});
}

void vary_dead_gyro_axis(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  ImuFault fault{.begin_s = draw_fault_begin_s(random), .duration_s = without_end_s};
  const int axis = random.uniform() < 0.6 ? 2 : random.integer_in(0, 1);
  fault.gyro_factor[axis] = 0.0;
  if (random.uniform() < 0.3) fault.gyro_offset_body_radps[axis] = random.uniform_in({-0.3, 0.3});  // stuck
  scenario.disturbances.imu_faults = {fault};
}

void vary_inverted_gyro_axis(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  ImuFault fault{.begin_s = draw_fault_begin_s(random), .duration_s = without_end_s};
  fault.gyro_factor.z() = -1.0;
  scenario.disturbances.imu_faults = {fault};
}

/// Draws another unit, sign or gain than declared.
void vary_wrong_accelerometer(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  ImuFault fault{.duration_s = without_end_s};
  const double kind = random.uniform();
  if (kind < 0.25) {
    fault.accel_factor.setConstant(1.0 / standard_gravity_mps2);
  } else if (kind < 0.5) {
    fault.accel_factor.setConstant(-1.0);
  } else if (kind < 0.75) {
    fault.accel_factor[random.integer_in(0, 1)] = -1.0;
  } else {
    fault.accel_factor.setConstant(random.uniform_in({0.8, 0.93}));
  }
  scenario.disturbances.imu_faults = {fault};
}

void vary_imu_scale(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  scenario.disturbances.imu_faults = {{.duration_s = without_end_s,
                                       .accel_factor = drawn_factors(random, {0.97, 1.03}),
                                       .gyro_factor = drawn_factors(random, {0.97, 1.03})}};
}

void vary_noisy_imu(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  const double kind = random.uniform();
  ImuFault fault{.begin_s = departure_s, .duration_s = without_end_s};
  if (kind < 0.6) fault.vibration_mps2 = random.uniform_in({0.5, 8.0});
  if (kind > 0.4) fault.vibration_radps = random.uniform_in({0.05, 0.5});
  scenario.disturbances.imu_faults = {fault};
}

void vary_coarse_fixes(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  scenario.sensors.fix_resolution_m = random.uniform_in({0.05, 0.2});
}

void vary_gyro_saturation(Scenario& scenario, Random& random) {
  scenario.sensors.gyro_limit_radps = random.uniform_in({4.4, 8.0});
}

void vary_loose_mount(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  double time_s = random.uniform_in({8.0, 20.0});
  while (time_s < scenario.duration_s) {
    const double held_s = random.uniform_in({5.0, 30.0});
    const double turned_rad = random.uniform_in({2.0, 12.0}) * per_deg;
    scenario.disturbances.imu_faults.push_back(
        {.begin_s = time_s, .duration_s = held_s, .turned_by_rad = turned_rad * random.direction()});
    time_s += held_s + random.uniform_in({3.0, 15.0});
  }
}

void vary_clock_offset(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  const double offset_s = random.uniform_in({0.05, 0.12});
  scenario.sensors.reported_delay_error_s = random.uniform() < 0.5 ? -offset_s : offset_s;
}

void vary_bias_field(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  const double amplitude_m = random.uniform_in({0.05, 0.3});
  const double wavelength_m = random.uniform_in({2.0, 8.0});
  scenario.disturbances.bias_field = {
      .amplitude_world_m = amplitude_m * random.direction(),
      .wave_radpm = 2.0 * std::numbers::pi / wavelength_m * random.horizontal_direction(),
      .phase_rad = random.uniform_in({-std::numbers::pi, std::numbers::pi})};
}

/// Draws a mount that is off, or a pair that is swapped for some seconds now and then.
void vary_wrong_headings(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  auto& errors = scenario.disturbances.heading_errors;
  if (random.uniform() < 0.5) {
    const double off_rad = random.uniform_in({8.0, 25.0}) * per_deg;
    errors = {{0.0, without_end_s, random.uniform() < 0.5 ? -off_rad : off_rad, true}};
    return;
  }
  for (double time_s = random.uniform_in({8.0, 15.0}); time_s < scenario.duration_s;) {
    const double swapped_s = random.uniform_in({1.0, 6.0});
    errors.push_back({time_s, swapped_s, std::numbers::pi, true});
    time_s += swapped_s + random.uniform_in({4.0, 15.0});
  }
}

/// Draws times in which the fixes scatter, or repeat.
void vary_bad_reception(Scenario& scenario, Random& random) {
  scenario.path = draw_path(random);
  for (double time_s = random.uniform_in({7.0, 12.0}); time_s < scenario.duration_s;) {
    const bool repeats = random.uniform() < 0.5;
    const double bad_s = random.uniform_in(repeats ? Range{0.5, 4.0} : Range{2.0, 10.0});
    const double noise_m = repeats ? 0.0 : random.uniform_in({0.1, 0.4});
    scenario.disturbances.fix_faults.push_back({time_s, bad_s, noise_m, repeats});
    time_s += bad_s + random.uniform_in({3.0, 10.0});
  }
}

/// Draws a single beacon with sparse fixes in a hall, and an IMU that falls silent.
void vary_silent_hall(Scenario& scenario, Random& random) {
  scenario = [&] {
    Scenario hall = find_scenario("hall");
    hall.name = scenario.name;
    hall.summary = scenario.summary;
    hall.vary(hall, random);
    return hall;
  }();
  scenario.sensors.fix_rate_hz = {4.0, 6.0};
  scenario.sensors.pair_heading = false;
  scenario.disturbances.imu_outages = {{random.uniform_in({15.0, 40.0}), random.uniform_in({2.0, 4.0})}};
}

std::vector<Scenario> make_violations() {
  return {
      {.name = "accel_bias_steps",
       .summary = "moves while the accelerometer's bias steps by 0.1 to 0.3 m/s² for 3 to 15 s",
       .path = walk_path,
       .vary = vary_accel_bias_steps},
      {.name = "warming_imu",
       .summary = "moves while the gyro's bias drifts by 0.3 to 0.8 deg/s and the accelerometer's steps",
       .path = walk_path,
       .vary = vary_warming_up},
      {.name = "door_sills",
       .summary = "moves over sills that hit the IMU with 5 to 12 m/s² for 20 to 40 ms",
       .path = forklift_path,
       .vary = vary_door_sills},
      {.name = "clipped_kerbs",
       .summary = "moves over kerbs of 20 to 45 m/s² with an accelerometer that clips at 4 g and vibrates",
       .path = forklift_path,
       .vary = vary_clipped_kerbs},
      {.name = "swaying",
       .summary = "walks to its place and leans to and fro by 0.2 to 0.7° at 0.1 to 0.4 Hz",
       .path = walk_path,
       .vary = vary_swaying},
      {.name = "flat_beacons",
       .summary = "moves while the height of the fixes has a noise of 0.3 to 0.5 m",
       .path = walk_path,
       .vary = vary_flat_beacons},
      {.name = "default_positions",
       .summary = "moves while a fifth to two fifths of the fixes are one default position",
       .path = walk_path,
       .vary = vary_default_positions},
      {.name = "dead_gyro_axis",
       .summary = "moves while one axis of the gyro is dead or stuck",
       .path = walk_path,
       .vary = vary_dead_gyro_axis},
      {.name = "inverted_gyro_axis",
       .summary = "moves while the gyro's Z axis is inverted",
       .path = walk_path,
       .vary = vary_inverted_gyro_axis},
      {.name = "wrong_accelerometer",
       .summary = "moves while the accelerometer has a wrong unit (g), a wrong sign or a gain of 0.8 to 0.93",
       .path = walk_path,
       .vary = vary_wrong_accelerometer},
      {.name = "imu_scale",
       .summary = "moves with scale errors of the IMU of up to 3 % per axis",
       .path = walk_path,
       .vary = vary_imu_scale},
      {.name = "noisy_imu",
       .summary = "moves while accelerometer or gyro have a white noise of up to 8 m/s² and 0.5 rad/s",
       .path = walk_path,
       .vary = vary_noisy_imu},
      {.name = "coarse_fixes",
       .summary = "moves while the fixes are rounded to 5 to 20 cm",
       .path = walk_path,
       .vary = vary_coarse_fixes},
      {.name = "gyro_saturation",
       .summary = "spins at up to 9 rad/s with a gyro that ends at 4 to 8 rad/s",
       .path = spin_path,
       .vary = vary_gyro_saturation},
      {.name = "loose_mount",
       .summary = "moves while the IMU turns by 2 to 12° in its mount for 5 to 30 s",
       .path = walk_path,
       .vary = vary_loose_mount},
      {.name = "clock_offset",
       .summary = "moves while the clocks of fixes and IMU differ by 50 to 120 ms",
       .path = walk_path,
       .vary = vary_clock_offset},
      {.name = "bias_field",
       .summary = "moves while the error of the fixes varies with the place by up to 0.3 m",
       .path = walk_path,
       .vary = vary_bias_field},
      {.name = "wrong_headings",
       .summary = "moves while the pair's heading is off by 8 to 25°, or opposite for 1 to 6 s",
       .path = walk_path,
       .vary = vary_wrong_headings},
      {.name = "bad_reception",
       .summary = "moves while the fixes scatter by 0.1 to 0.4 m for 2 to 10 s, or repeat for 0.5 to 4 s",
       .path = walk_path,
       .vary = vary_bad_reception},
      {.name = "silent_hall",
       .summary = "drives a hall with a single beacon, sparse fixes and an IMU that is silent for seconds",
       .path = forklift_path,
       .random_start_yaw = true,
       .score_after_s = 20,
       .vary = vary_silent_hall},
  };
}

}  // namespace

std::span<const Scenario> violations() {
  static const std::vector<Scenario> all = make_violations();
  return all;
}

}  // namespace sonopose::sim
