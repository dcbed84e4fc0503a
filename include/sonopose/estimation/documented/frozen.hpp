#pragma once
/// \file
/// Frozen track: fixes repeat the same coordinates while the IMU measures motion. (Beacons at rest repeat
/// coordinates too.)

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
  // The inertial path at the start of the window, with the velocity corrections of that time: fixes of a
  // frozen track correct the velocity to zero.
  TimeNs window_began_ns = 0;
  Vector3d window_displacement_world_m = Vector3d::Zero();
  Vector3d window_corrections_world_mps = Vector3d::Zero();

  bool operator==(const FrozenState&) const = default;
};

namespace frozen {

/// Adds an admitted fix. Returns true while the track is frozen, which ends with the first different
/// coordinate.
bool update(const FrozenSettings& settings, FrozenState& state, const Kinematics& body,
            const UltrasonicFix& fix);

/// Restarts the window after a gap in the inertial path.
void begin_window(FrozenState& state, const Kinematics& body);

}  // namespace frozen
}  // namespace sonopose::estimation::documented
