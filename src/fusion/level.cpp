#include <sonopose/fusion/level.hpp>

#include <algorithm>

namespace sonopose::fusion::level {

void learn(const LevelSettings& settings, LevelState& state, attitude::Mahony& filter,
           const Vector3d& velocity_change_world_mps) {
  // A turn φ of the attitude adds φ × g·z to the acceleration: φ = z × dv / g turns it towards dv.
  const Vector3d turn_world_rad =
      settings.tilt_gain_hz / standard_gravity_mps2 * Vector3d::UnitZ().cross(velocity_change_world_mps);
  filter.turn_in_world(turn_world_rad);
  state.vertical_offset_mps2 =
      std::clamp(state.vertical_offset_mps2 + settings.vertical_gain_hz * velocity_change_world_mps.z(),
                 -settings.max_vertical_mps2, settings.max_vertical_mps2);
}

}  // namespace sonopose::fusion::level
