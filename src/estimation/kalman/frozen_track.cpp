// Fixes that repeat their coordinates while the IMU measures a motion.

#include "estimation/kalman/belief_parts.hpp"

namespace sonopose::estimation::kalman {

/// Whether the coordinates only repeat while the IMU measures a motion.
bool Belief::check_frozen(const settings::FrozenSettings& settings, const FixMeasurement& fix) {
  const auto begin_window = [&] {
    repetition.began_ns = time_ns;
    repetition.moved_world_m.setZero();
    repetition.velocity_world_mps =
        phase == Phase::waiting ? Vector3d::Zero() : filter().tracked_velocity_world_mps();
  };
  const bool repeated =
      repetition.has_fix && is_same_position(fix.position_world_m, repetition.coordinates_world_m);
  if (!repeated) {
    repetition.has_fix = true;
    repetition.frozen = false;
    repetition.repeats = 0;
    repetition.coordinates_world_m = fix.position_world_m;
    begin_window();
    return false;
  }
  ++repetition.repeats;
  if (repetition.frozen) return true;
  repetition.frozen =
      repetition.repeats >= settings.repeats && repetition.moved_world_m.norm() > settings.moved_m;
  if (repetition.frozen) {
    // The repeated fixes before the detection slowed the filters down.
    const Vector3d lost_mps = repetition.velocity_world_mps - filter().tracked_velocity_world_mps();
    const Vector3d lost_m =
        repetition.coordinates_world_m + repetition.moved_world_m - filter().tracked_position_world_m();
    for (int i = 0; i < candidate_count; ++i) {
      Filter& each = candidates[static_cast<std::size_t>(i)].filter;
      each.velocity_world_mps += lost_mps;
      each.position_world_m += lost_m;
      each.add_variance(at_velocity, Vector3d::Constant(square(0.3)));
      each.add_variance(at_position, Vector3d::Constant(square(0.1)));
    }
    rival.alive = false;
  } else if (seconds_between(repetition.began_ns, time_ns) > settings.window_s) {
    begin_window();
  }
  return repetition.frozen;
}

}  // namespace sonopose::estimation::kalman
