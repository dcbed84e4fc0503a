#pragma once
/// \file
/// Paths of straight legs with turns and stops between them, in laps that end where they began.

#include "sim/trajectory.hpp"

#include <span>

namespace sonopose::sim {

/// Drive from rest to rest with smooth ramps: 0 before `begin_s`, `way` after begin + way / speed + ramp.
Jet drive(double time_s, double begin_s, double way, double speed, double ramp_s);

/// Time within a lap; 0 before the departure.
double time_in_lap(double time_s, double lap_s);

/// One leg: drives `length_m` straight ahead, stops, turns by `turn_rad` to the left on the spot, stops. A
/// rolling leg turns without a stop into the next one, which must have the same ramp: the velocity changes
/// over from one direction to the other within the ramp.
struct Leg {
  double length_m = 0;
  double speed_mps = 0;
  double ramp_s = 0;
  double stop_s = 0;  ///< pause before the turn
  double turn_rad = 0;
  double ready_s = 0;  ///< pause after the turn
  bool rolling = false;
};

inline constexpr double quarter_turn_s = 1.6;  ///< duration of a quarter turn, at up to 1.84 rad/s

/// Time from the start of a leg to that of the next.
double duration_s(const Leg& leg);

/// Path of a truck that drives the lap repeatedly, from (1, 1) along X. The tracked point is
/// `ahead_of_pivot_m` in front of the point about which the truck turns. The last leg must not roll.
Path truck_path(std::span<const Leg> lap, double ahead_of_pivot_m, double height_m, double time_s);

}  // namespace sonopose::sim
