#include <sonopose/estimation/aiding/default_position.hpp>
#include <sonopose/estimation/kalman/frozen_track.hpp>

namespace sonopose::estimation::kalman {

void FrozenTrackDetector::move(double duration_s, const Vector3d& acceleration_world_mps2) {
  moved_world_m += duration_s * velocity_world_mps;
  velocity_world_mps += duration_s * acceleration_world_mps2;
}

bool FrozenTrackDetector::add(const settings::FrozenSettings& settings, TimeNs time_ns,
                              const Vector3d& position_world_m, const Vector3d& begin_velocity_world_mps) {
  const bool repeated = has_fix && aiding::is_same_position(position_world_m, coordinates_world_m);
  repeats = repeated ? repeats + 1 : 0;
  frozen = repeated && (frozen || (repeats >= settings.repeats && moved_world_m.norm() > settings.moved_m));
  if (!repeated || (!frozen && seconds_between(began_ns, time_ns) > settings.window_s)) {
    has_fix = true;
    coordinates_world_m = position_world_m;
    began_ns = time_ns;
    moved_world_m.setZero();
    velocity_world_mps = begin_velocity_world_mps;
  }
  return frozen;
}

}  // namespace sonopose::estimation::kalman
