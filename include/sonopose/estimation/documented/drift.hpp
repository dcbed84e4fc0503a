#pragma once
/// \file
/// Items 2, 4 and 9: the position correction by a fix. A part is immediate; the rest follows a second-order
/// decay.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/trust.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::DriftSettings;

struct DriftState {
  Vector3d offset_world_m = Vector3d::Zero();      ///< d: offset that is still to be applied
  Vector3d velocity_world_mps = Vector3d::Zero();  ///< u: velocity at which it is applied
  double weight = 0;                               ///< weight of the fix that set d

  bool operator==(const DriftState&) const = default;
};

namespace drift {

/// Share of the position error that a fix removes immediately (item 4, or item 21 if that is more).
[[nodiscard]] double jump_share(const DriftSettings& settings, const FixAssessment& assessment);

/// Applies a fix: p += jump · e immediately; the rest *replaces* d, so that offsets never accumulate. Returns
/// the jump.
Vector3d correct(const DriftSettings& settings, DriftState& state, Kinematics& body, const TimedFix& fix,
                 const FixAssessment& assessment);

/// Performs one IMU step: u follows u* = decay · w · d at the smoothing rate; p += u·dt, d −= u·dt.
void apply_decay(const DriftSettings& settings, DriftState& state, Kinematics& body, double dt_s);

}  // namespace drift
}  // namespace sonopose::estimation::documented
