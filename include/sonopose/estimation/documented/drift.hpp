#pragma once
/// \file
/// Items 2, 4 and 9: the position correction by a fix: a part at once, the rest through a second-order decay.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/trust.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::DriftSettings;

struct DriftState {
  Vector3d offset_world_m = Vector3d::Zero();      ///< d: still to be applied
  Vector3d velocity_world_mps = Vector3d::Zero();  ///< u: at which it is applied
  double weight = 0;                               ///< of the fix that set d

  bool operator==(const DriftState&) const = default;
};

namespace drift {

/// The share of the position error that a fix removes at once (item 4, or item 21 if that is more).
[[nodiscard]] double jump_share(const DriftSettings& settings, const FixAssessment& assessment);

/// A fix: p += jump · e at once; the rest *replaces* d, so that offsets never accumulate. Returns the jump.
Vector3d correct(const DriftSettings& settings, DriftState& state, Kinematics& body, const TimedFix& fix,
                 const FixAssessment& assessment);

/// One IMU step: u follows u* = decay · w · d at the smoothing rate; p += u·dt, d −= u·dt.
void apply_decay(const DriftSettings& settings, DriftState& state, Kinematics& body, double dt_s);

}  // namespace drift
}  // namespace sonopose::estimation::documented
