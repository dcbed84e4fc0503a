/// Paths with stops: straight segments and turns on the spot, one after the other, in laps that end where they
/// began.

#include "sim/paths.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace sonopose::sim {

namespace {

using std::numbers::pi;

/// From rest to rest: 0 before `begin_s`, `way` after begin + way / speed + ramp. Speed and its ramps are
/// smooth.
Jet drive(double time_s, double begin_s, double way, double speed, double ramp_s) {
  return smooth_departure(time_s, begin_s, ramp_s, speed) -
         smooth_departure(time_s, begin_s + way / speed, ramp_s, speed);
}

/// Drives `length_m` straight on, stands, turns by `turn_rad` to the left, stands.
struct Leg {
  double length_m = 0;
  double speed_mps = 0;
  double ramp_s = 0;
  double stop_s = 0;  ///< before the turn
  double turn_rad = 0;
  double ready_s = 0;  ///< after the turn
};

constexpr double quarter_turn_s = 1.6;  ///< up to 1.84 rad/s

constexpr double duration_s(const Leg& leg) {
  return leg.length_m / leg.speed_mps + leg.ramp_s + leg.stop_s + quarter_turn_s + leg.ready_s;
}

/// Speeds and ramps keep below 2 m/s². Six turns, one of them to the right: a lap looks where it began.
constexpr std::array forklift_lap{
    Leg{6.0, 2.0, 2.0, 1.0, pi / 2, 0.3},  Leg{3.0, 1.4, 1.5, 0.2, -pi / 2, 0.2},
    Leg{4.0, 1.6, 1.7, 2.0, pi / 2, 1.0},  Leg{5.0, 2.0, 2.0, 0.3, pi / 2, 0.3},
    Leg{10.0, 2.0, 2.0, 1.5, pi / 2, 0.5}, Leg{8.0, 2.0, 2.0, 0.5, pi / 2, 1.0},
};

/// The time within a lap; the lap's whole turns do not show in the yaw.
double time_in_lap(double time_s, double lap_s) {
  return time_s < departure_s ? 0.0 : std::fmod(time_s - departure_s, lap_s);
}

}  // namespace

Path forklift_path(double time_s) {
  constexpr double ahead_of_pivot_m = 0.2;  // the beacon's place on the truck
  constexpr double lap_s = [] {
    double sum_s = 0;
    for (const Leg& leg : forklift_lap) sum_s += duration_s(leg);
    return sum_s;
  }();
  const double t = time_in_lap(time_s, lap_s);
  Jet x = 1.0;
  Jet y = 1.0;
  Jet yaw = 0.0;
  double direction_rad = 0;
  double begin_s = 0;
  for (const Leg& leg : forklift_lap) {
    const Jet way_m = drive(t, begin_s, leg.length_m, leg.speed_mps, leg.ramp_s);
    x = x + std::cos(direction_rad) * way_m;
    y = y + std::sin(direction_rad) * way_m;
    const double turn_begin_s = begin_s + leg.length_m / leg.speed_mps + leg.ramp_s + leg.stop_s;
    yaw = yaw + leg.turn_rad * smooth_step({(t - turn_begin_s) / quarter_turn_s, 1.0 / quarter_turn_s, 0.0});
    direction_rad += leg.turn_rad;
    begin_s += duration_s(leg);
  }
  return {.x = x + ahead_of_pivot_m * cos(yaw),
          .y = y + ahead_of_pivot_m * sin(yaw),
          .z = 1.5,
          .yaw = yaw,
          .pitch = 0.0,
          .roll = 0.0};
}

Path spin_path(double time_s) {
  // One lap: turn left, drive to the far place, turn right there, drive back.
  constexpr double rate_radps = 9.0;
  constexpr double ramp_s = 2.0;
  constexpr double spin_s = 6.0;  // with one ramp; it takes another to end
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

}  // namespace sonopose::sim
