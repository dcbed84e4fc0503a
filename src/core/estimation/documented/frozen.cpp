#include <sonopose/estimation/aiding/default_position.hpp>
#include <sonopose/estimation/documented/frozen.hpp>

namespace sonopose::estimation::documented::frozen {

void begin_window(FrozenState& state, const Kinematics& body) {
  state.window_began_ns = body.time_ns;
  state.window_displacement_world_m = body.displacement_world_m;
  state.window_corrections_world_mps = body.velocity_corrections_world_mps;
}

bool update(const FrozenSettings& settings, FrozenState& state, const Kinematics& body,
            const UltrasonicFix& fix) {
  const bool repeated =
      state.has_fix && aiding::is_same_position(fix.position_world_m, state.coordinates_world_m);
  if (!repeated) {
    state = FrozenState{};
    state.has_fix = true;
    state.coordinates_world_m = fix.position_world_m;
    begin_window(state, body);
    return false;
  }
  ++state.repeats;
  if (state.frozen) return true;

  const double window_s = seconds_between(state.window_began_ns, body.time_ns);
  const Vector3d moved_world_m = body.displacement_world_m - state.window_displacement_world_m +
                                 state.window_corrections_world_mps * window_s;
  state.frozen = state.repeats >= settings.repeats && moved_world_m.norm() > settings.moved_m;
  if (!state.frozen && window_s > settings.window_s) begin_window(state, body);
  return state.frozen;
}

}  // namespace sonopose::estimation::documented::frozen
