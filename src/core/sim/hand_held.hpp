#pragma once
/// \file
/// A device in the hand of a walking person: it tilts, turns and shakes.

#include "sim/random.hpp"
#include "sim/trajectory.hpp"

#include <array>

namespace sonopose::sim {

/// The oscillation amplitude · sin(rate · time + phase), in m or rad.
struct Swing {
  double amplitude = 0;
  double rate_radps = 0;
  double phase_rad = 0;
};

/// Motion that the hand adds to the walk. Shaking is fast and small, the rest slow and large.
struct HandMotion {
  std::array<Swing, 3> reach_world_m{};
  std::array<Swing, 3> shaking_world_m{};
  std::array<Swing, 3> turning_rad{};  ///< yaw, pitch, roll
  std::array<Swing, 3> shaking_rad{};  ///< yaw, pitch, roll
};

/// Largest angle between body Z and the vertical.
inline constexpr double max_hand_tilt_deg = 60.0;

/// Draws a motion whose tilt reaches 30° to 60° where its pitch and roll peak together, and never more.
HandMotion draw_hand_motion(Random& random);

/// The walk with this motion, which begins at the departure.
Path hand_held_path(const HandMotion& hand, double time_s);

}  // namespace sonopose::sim
