#include "sim/paths.hpp"

#include "sim/taylor.hpp"

#include <array>
#include <numbers>

namespace sonopose::sim {

namespace {

using std::numbers::pi;

constexpr Jet clock(double time_s) {
  return {time_s, 1.0, 0.0};
}

/// Rises from 0 to 1 within `ramp_s` of the departure.
Jet gait_of(double time_s, double ramp_s) {
  return smooth_step({(time_s - departure_s) / ramp_s, 1.0 / ramp_s, 0.0});
}

Path eight_on_foot(double time_s, double eights_radps, double step_hz) {
  constexpr double ramp_s = 1.5;
  const Jet u = smooth_departure(time_s, departure_s, ramp_s, eights_radps);
  const Jet two_u = Jet{2.0} * u;
  const Jet t = clock(time_s);
  const Jet gait = gait_of(time_s, ramp_s);
  const Jet step = Jet{2.0 * pi * step_hz} * t;
  const Jet stride = Jet{pi * step_hz} * t;
  return {.x = 3.0 + Jet{2.0} * sin(u),
          .y = 2.0 + sin(two_u),
          .z = 1.0 + Jet{0.01} * gait * sin(step),
          .yaw = atan2(cos(two_u), cos(u)),  // the tangent (2 cos u, 2 cos 2u), which is never zero
          .pitch = Jet{0.03} * gait * cos(step),
          .roll = Jet{0.04} * gait * sin(stride)};
}

/// Accelerations stay below 2 m/s². Six turns, one of them to the right: a lap ends in its initial direction.
constexpr std::array forklift_lap{
    Leg{6.0, 2.0, 2.0, 1.0, pi / 2, 0.3},  Leg{3.0, 1.4, 1.5, 0.2, -pi / 2, 0.2},
    Leg{4.0, 1.6, 1.7, 2.0, pi / 2, 1.0},  Leg{5.0, 2.0, 2.0, 0.3, pi / 2, 0.3},
    Leg{10.0, 2.0, 2.0, 1.5, pi / 2, 0.5}, Leg{8.0, 2.0, 2.0, 0.5, pi / 2, 1.0},
};

}  // namespace

Path rest_path(double /*time_s*/) {
  return {.x = 1.0, .y = 2.0, .z = 0.5, .yaw = 0.5, .pitch = 0.0, .roll = 0.0};
}

Path walk_path(double time_s) {
  return eight_on_foot(time_s, 0.45, 1.8);
}

Path stroll_path(double time_s) {
  return eight_on_foot(time_s, 0.18, 1.2);
}

Path circle_path(double time_s) {
  constexpr double radius_m = 8.0;
  const Jet angle = smooth_departure(time_s, departure_s, 4.0, 6.0 / radius_m);
  return {.x = 10.0 + Jet{radius_m} * sin(angle),
          .y = 10.0 - Jet{radius_m} * cos(angle),
          .z = 0.2,
          .yaw = angle,
          .pitch = 0.0,
          .roll = 0.0};
}

Path kart_path(double time_s) {
  constexpr double half_length_m = 14.0;
  constexpr double half_width_m = 4.5;
  const Jet phase = smooth_departure(time_s, departure_s, 5.0, 0.48);
  // A uniform phase would give 8 m/s in the middle and 4.5 m/s in the curves.
  const Jet u = phase - Jet{0.12} * sin(Jet{2.0} * phase);
  const Jet two_u = Jet{2.0} * u;
  const Jet along_x = Jet{half_length_m} * cos(u);
  const Jet along_y = Jet{2.0 * half_width_m} * cos(two_u);
  const Jet under_way = gait_of(time_s, 5.0);
  return {.x = 16.0 + Jet{half_length_m} * sin(u),
          .y = 6.0 + Jet{half_width_m} * sin(two_u),
          .z = 0.2,
          .yaw = atan2(along_y, along_x),
          .pitch = Jet{0.015} * under_way * sin(two_u),
          .roll = Jet{-0.03} * sin(u)};  // leans out of the curve: to the right for u in (0, π)
}

std::span<const Leg> forklift_legs() {
  return forklift_lap;
}

Path forklift_path(double time_s) {
  return truck_path(forklift_lap, beacon_ahead_of_pivot_m, 1.5, time_s);
}

Path spin_path(double time_s) {
  // One lap: turn left, drive away, turn right, drive back.
  constexpr double rate_radps = 9.0;
  constexpr double ramp_s = 2.0;
  constexpr double spin_s = 6.0;  // including one of the two ramps
  constexpr double pause_s = 1.0;
  constexpr double way_m = 2.0;
  constexpr double speed_mps = 1.0;
  constexpr double drive_s = way_m / speed_mps + ramp_s;
  constexpr double half_lap_s = spin_s + ramp_s + pause_s + drive_s + pause_s;
  const double t = time_in_lap(time_s, 2.0 * half_lap_s);
  const double drive_begin_s = spin_s + ramp_s + pause_s;
  constexpr double turn_rad = rate_radps * spin_s;
  const Jet way = drive(t, drive_begin_s, way_m, speed_mps, ramp_s) -
                  drive(t, half_lap_s + drive_begin_s, way_m, speed_mps, ramp_s);
  const Jet yaw =
      drive(t, 0.0, turn_rad, rate_radps, ramp_s) - drive(t, half_lap_s, turn_rad, rate_radps, ramp_s);
  return {.x = 2.0 + 0.8 * way, .y = 2.0 + 0.6 * way, .z = 0.8, .yaw = yaw, .pitch = 0.0, .roll = 0.0};
}

/// The attitude follows from the acceleration.
Path drone_path(double time_s) {
  const Taylor away = smoother_step(time_s, departure_s, 5.0);
  const double t = time_s - departure_s;
  const Taylor x = Taylor::constant(4.0) + away * (sine(2.0, 0.60, 0.0, t) + sine(0.25, 1.7, 1.0, t));
  const Taylor y = Taylor::constant(3.0) + away * (sine(1.3, 0.93, 0.5, t) + sine(0.15, 2.1, 0.0, t));
  const Taylor z = Taylor::constant(0.1) + away * (Taylor::constant(1.5) + sine(0.7, 0.45, -1.0, t));
  const Jet yaw = smooth_departure(time_s, departure_s, 4.0, 0.2);

  // Thrust per mass in the yaw-aligned frame; pitch and roll align body Z with it.
  const Jet thrust_x = x.second_derivative();
  const Jet thrust_y = y.second_derivative();
  const Jet thrust_z = standard_gravity_mps2 + z.second_derivative();
  const Jet forward = cos(yaw) * thrust_x + sin(yaw) * thrust_y;
  const Jet left = cos(yaw) * thrust_y - sin(yaw) * thrust_x;
  const Jet pitch = atan2(forward, thrust_z);
  const Jet in_plane = forward * sin(pitch) + thrust_z * cos(pitch);
  return {
      .x = x.jet(), .y = y.jet(), .z = z.jet(), .yaw = yaw, .pitch = pitch, .roll = atan2(-left, in_plane)};
}

}  // namespace sonopose::sim
