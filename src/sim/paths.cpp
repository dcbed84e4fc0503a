#include "sim/paths.hpp"

#include <numbers>

namespace sonopose::sim {

namespace {

using std::numbers::pi;

constexpr Jet clock(double time_s) {
  return {time_s, 1.0, 0.0};
}

/// From 0 to 1 within `ramp_s` of the departure.
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
          .yaw = atan2(cos(two_u), cos(u)),  // the tangent (2 cos u, 2 cos 2u), which is nowhere zero
          .pitch = Jet{0.03} * gait * cos(step),
          .roll = Jet{0.04} * gait * sin(stride)};
}

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
  // At an even phase the eight would be driven at 8 m/s in the middle and 4.5 in the curves.
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
          .roll = Jet{-0.03} * sin(u)};  // leans out of the curve: right where u is in (0, π)
}

}  // namespace sonopose::sim
