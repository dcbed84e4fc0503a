#pragma once
/// \file
/// Paths of the scenarios. Each rests until `departure_s`, so that gyroscopes can be calibrated, and then
/// continues without end. Positions are in metres, angles in radians.

#include "sim/laps.hpp"
#include "sim/trajectory.hpp"

#include <span>

namespace sonopose::sim {

inline constexpr double departure_s = 3.0;

Path rest_path(double time_s);

/// A person carries the beacon along a figure eight of 4 m × 2 m at 0.6–1.3 m/s and bobs with each step.
Path walk_path(double time_s);

/// The walk at less than half the speed.
Path stroll_path(double time_s);

/// A kart at 6 m/s on a circle of 8 m radius: 0.75 rad/s and 4.5 m/s² to the side.
Path circle_path(double time_s);

/// A kart on a figure eight of 28 m × 9 m: 5–6.5 m/s, up to 6 m/s² to either side.
Path kart_path(double time_s);

/// A forklift between shelves of 10 m × 8 m: up to 2 m/s, stops, quarter turns nearly on the spot.
Path forklift_path(double time_s);

/// Legs of the forklift's lap.
std::span<const Leg> forklift_legs();

/// Place of the forklift's beacon.
inline constexpr double beacon_ahead_of_pivot_m = 0.2;

/// Turns about the tracked point at 9 rad/s to either side, and drives at 1 m/s between the turns.
Path spin_path(double time_s);

/// A quadrotor: the thrust for its motion is along body Z.
Path drone_path(double time_s);

}  // namespace sonopose::sim
