#pragma once
/// \file
/// Items 23 and 24: emergency damping of a velocity that points away from the last valid fix.

#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::RunawaySettings;

struct RunawayState {
  bool has_fix = false;
  Vector3d fix_position_world_m = Vector3d::Zero();  ///< last valid fix

  bool operator==(const RunawayState&) const = default;
};

namespace runaway {

/// Damps the velocity over one IMU step if the body is far from the last valid fix and moves away from it.
void damp(const RunawaySettings& settings, const RunawayState& state, Kinematics& body, double dt_s);

}  // namespace runaway
}  // namespace sonopose::estimation::documented
