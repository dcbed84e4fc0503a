#include "sim/hand_held.hpp"

#include "sim/paths.hpp"
#include "sim/taylor.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <numbers>

namespace sonopose::sim {

namespace {

constexpr double per_hz_radps = 2.0 * std::numbers::pi;

Swing draw_swing(Random& random, double amplitude, const Range& rate_hz) {
  const double rate_radps = per_hz_radps * random.uniform_in(rate_hz);
  return {amplitude, rate_radps, random.uniform_in({-std::numbers::pi, std::numbers::pi})};
}

Jet at(const Swing& swing, double time_s) {
  return sine(swing.amplitude, swing.rate_radps, swing.phase_rad, time_s).jet();
}

}  // namespace

HandMotion draw_hand_motion(Random& random) {
  constexpr Range reach_hz{0.3, 0.8};
  constexpr Range shaking_hz{3.0, 6.0};
  constexpr Range turning_hz{0.15, 0.5};
  constexpr double max_shaking_deg = 2.0;
  constexpr double per_deg = geometry::radians_per_degree;
  HandMotion hand;
  for (Swing& swing : hand.reach_world_m) {
    swing = draw_swing(random, random.uniform_in({0.05, 0.25}), reach_hz);
  }
  for (Swing& swing : hand.shaking_world_m) {
    swing = draw_swing(random, random.uniform_in({0.003, 0.010}), shaking_hz);
  }
  for (Swing& swing : hand.shaking_rad) {
    swing = draw_swing(random, random.uniform_in({0.5, max_shaking_deg}) * per_deg, shaking_hz);
  }
  // The tilt is at most the root of the sum of the squares of pitch and roll.
  const double margin_deg = std::numbers::sqrt2 * max_shaking_deg;
  const double tilt_rad =
      random.uniform_in({0.5 * max_hand_tilt_deg, max_hand_tilt_deg - margin_deg}) * per_deg;
  const Vector3d axis = random.horizontal_direction();
  hand.turning_rad = {draw_swing(random, random.uniform_in({0.3, 1.2}), turning_hz),
                      draw_swing(random, tilt_rad * axis.x(), turning_hz),
                      draw_swing(random, tilt_rad * axis.y(), turning_hz)};
  return hand;
}

Path hand_held_path(const HandMotion& hand, double time_s) {
  constexpr double ramp_s = 1.5;
  const Jet held = smooth_step({(time_s - departure_s) / ramp_s, 1.0 / ramp_s, 0.0});
  const auto moved = [&](const std::array<Swing, 3>& slow, const std::array<Swing, 3>& fast, std::size_t i) {
    return held * (at(slow.at(i), time_s) + at(fast.at(i), time_s));
  };
  Path path = walk_path(time_s);
  path.x = path.x + moved(hand.reach_world_m, hand.shaking_world_m, 0);
  path.y = path.y + moved(hand.reach_world_m, hand.shaking_world_m, 1);
  path.z = path.z + moved(hand.reach_world_m, hand.shaking_world_m, 2);
  path.yaw = path.yaw + moved(hand.turning_rad, hand.shaking_rad, 0);
  path.pitch = moved(hand.turning_rad, hand.shaking_rad, 1);
  path.roll = moved(hand.turning_rad, hand.shaking_rad, 2);
  return path;
}

}  // namespace sonopose::sim
