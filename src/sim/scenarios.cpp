#include <sonopose/sim/trajectory.hpp>

#include <array>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sonopose::sim {

namespace {

using std::numbers::pi;

constexpr double departure_s =
    3.0;  ///< every moving scenario rests until then, so that gyros can be calibrated

constexpr Jet clock(double time_s) {
  return {time_s, 1.0, 0.0};
}

Path rest(double /*time_s*/) {
  return {.x = 1.0, .y = 2.0, .z = 0.5, .yaw = 0.5, .pitch = 0.0, .roll = 0.0};
}

/// A person carries the beacon through a lying eight of 4 m × 2 m, 0.6–1.3 m/s, and bobs with each step.
Path walk(double time_s) {
  constexpr double ramp_s = 1.5;
  constexpr double step_hz = 1.8;
  const Jet u = smooth_departure(time_s, departure_s, ramp_s, 0.45);
  const Jet two_u = Jet{2.0} * u;
  const Jet t = clock(time_s);
  const Jet gait = smooth_step({(time_s - departure_s) / ramp_s, 1.0 / ramp_s, 0.0});
  const Jet step = Jet{2.0 * pi * step_hz} * t;
  const Jet stride = Jet{pi * step_hz} * t;
  return {.x = 3.0 + Jet{2.0} * sin(u),
          .y = 2.0 + sin(two_u),
          .z = 1.0 + Jet{0.01} * gait * sin(step),
          .yaw = atan2(cos(two_u), cos(u)),  // the tangent (2 cos u, 2 cos 2u), which is nowhere zero
          .pitch = Jet{0.03} * gait * cos(step),
          .roll = Jet{0.04} * gait * sin(stride)};
}

/// A kart goes to 6 m/s on a circle of 8 m radius: 0.75 rad/s and 4.5 m/s² to the side.
Path circle(double time_s) {
  constexpr double radius_m = 8.0;
  const Jet angle = smooth_departure(time_s, departure_s, 4.0, 6.0 / radius_m);
  return {.x = 10.0 + Jet{radius_m} * sin(angle),
          .y = 10.0 - Jet{radius_m} * cos(angle),
          .z = 0.2,
          .yaw = angle,
          .pitch = 0.0,
          .roll = 0.0};
}

constexpr std::array all_scenarios{
    Scenario{"rest", "stands still, level", rest},
    Scenario{"walk", "rests 3 s, then walks a closed path of a few metres at about 1 m/s", walk},
    Scenario{"circle", "rests 3 s, then drives a circle of 8 m radius at 6 m/s, as a kart does", circle},
};

}  // namespace

std::span<const Scenario> scenarios() {
  return all_scenarios;
}

const Scenario& find_scenario(std::string_view name) {
  std::string known;
  for (const Scenario& scenario : all_scenarios) {
    if (scenario.name == name) return scenario;
    known += known.empty() ? "" : ", ";
    known += scenario.name;
  }
  throw std::invalid_argument("unknown scenario \"" + std::string(name) + "\"; known are " + known);
}

}  // namespace sonopose::sim
