#pragma once
/// \file
/// Items 23 and 24: emergency damping of a velocity that points away from the last fix that was not an
/// outlier.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/trust.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::RunawaySettings;

struct RunawayState {
  bool has_fix = false;
  Vector3d fix_position_world_m = Vector3d::Zero();  ///< last valid fix that was not an outlier

  bool operator==(const RunawayState&) const = default;
};

namespace runaway {

/// Makes a fix the new reference if it is not an outlier. Outliers that agree with each other carry the
/// reference along: on a wrong track the body moves as on the right one.
void update_reference(RunawayState& state, const TimedFix& fix, const FixAssessment& assessment);

/// Damps the velocity over one IMU step if the body is far from the reference and moves away.
void damp(const RunawaySettings& settings, const RunawayState& state, Kinematics& body, double dt_s);

}  // namespace runaway
}  // namespace sonopose::estimation::documented
