#include "sim/laps.hpp"

#include "sim/paths.hpp"

#include <cmath>

namespace sonopose::sim {

namespace {

constexpr double turn_s(const Leg& leg) {
  return leg.turn_rad == 0.0 ? 0.0 : quarter_turn_s;
}

/// Step from 0 before `begin_s` to 1 after begin + duration.
Jet step_from(double begin_s, double duration_s, double time_s) {
  return smooth_step({(time_s - begin_s) / duration_s, 1.0 / duration_s, 0.0});
}

/// Direction of the velocity while it changes over to that of the next leg.
Jet rolling_turn(const Leg& leg, double next_speed_mps, const Jet& changed) {
  return atan2(next_speed_mps * std::sin(leg.turn_rad) * changed,
               leg.speed_mps * (1.0 - changed) + next_speed_mps * std::cos(leg.turn_rad) * changed);
}

}  // namespace

Jet drive(double time_s, double begin_s, double way, double speed, double ramp_s) {
  return smooth_departure(time_s, begin_s, ramp_s, speed) -
         smooth_departure(time_s, begin_s + way / speed, ramp_s, speed);
}

double time_in_lap(double time_s, double lap_s) {
  return time_s < departure_s ? 0.0 : std::fmod(time_s - departure_s, lap_s);
}

double duration_s(const Leg& leg) {
  if (leg.rolling) return leg.length_m / leg.speed_mps;
  return leg.length_m / leg.speed_mps + leg.ramp_s + leg.stop_s + turn_s(leg) + leg.ready_s;
}

Path truck_path(std::span<const Leg> lap, double ahead_of_pivot_m, double height_m, double time_s) {
  double lap_s = 0;
  for (const Leg& leg : lap) lap_s += duration_s(leg);
  const double t = time_in_lap(time_s, lap_s);
  Jet x = 1.0;
  Jet y = 1.0;
  Jet yaw = 0.0;
  double direction_rad = 0;
  double begin_s = 0;
  for (std::size_t i = 0; i < lap.size(); ++i) {
    const Leg& leg = lap[i];
    const Jet way_m = drive(t, begin_s, leg.length_m, leg.speed_mps, leg.ramp_s);
    x = x + std::cos(direction_rad) * way_m;
    y = y + std::sin(direction_rad) * way_m;
    const double end_s = begin_s + leg.length_m / leg.speed_mps;
    if (leg.rolling) {
      yaw = yaw + rolling_turn(leg, lap[i + 1].speed_mps, step_from(end_s, leg.ramp_s, t));
    } else {
      yaw = yaw + leg.turn_rad * step_from(end_s + leg.ramp_s + leg.stop_s, quarter_turn_s, t);
    }
    direction_rad += leg.turn_rad;
    begin_s += duration_s(leg);
  }
  return {.x = x + ahead_of_pivot_m * cos(yaw),
          .y = y + ahead_of_pivot_m * sin(yaw),
          .z = height_m,
          .yaw = yaw,
          .pitch = 0.0,
          .roll = 0.0};
}

}  // namespace sonopose::sim
