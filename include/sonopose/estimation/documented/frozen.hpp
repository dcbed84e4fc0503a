#pragma once
/// \file
/// The frozen track: fixes that repeat the same coordinates while the IMU says that the body moves. (At rest
/// real beacons repeat coordinates too.)

#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::FrozenSettings;

struct FrozenState {
  bool has_fix = false;
  bool frozen = false;
  int repeats = 0;
  Vector3d coordinates_world_m = Vector3d::Zero();
  // Where the window began: the IMU's path since then, with the velocity as it was then, because fixes of a
  // frozen track pull the velocity to zero.
  TimeNs window_began_ns = 0;
  Vector3d window_displacement_world_m = Vector3d::Zero();
  Vector3d window_corrections_world_mps = Vector3d::Zero();

  bool operator==(const FrozenState&) const = default;
};

namespace frozen {

/// Takes note of an admitted fix; true while the track counts as frozen. Ends with the first new coordinate.
bool watch(const FrozenSettings& settings, FrozenState& state, const Kinematics& body,
           const UltrasonicFix& fix);

/// The IMU's path has a hole here: what it draws from now on is measured from here.
void begin_window(FrozenState& state, const Kinematics& body);

}  // namespace frozen
}  // namespace sonopose::estimation::documented
