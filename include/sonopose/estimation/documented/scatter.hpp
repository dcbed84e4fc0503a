#pragma once
/// \file
/// The noise of the fixes, learned per axis, so that an axis that is much noisier than item 13 says counts by
/// less (trust). Beacons that hang at one height measure the height badly.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::documented {

struct ScatterState {
  static constexpr double least_m = 0.01;
  static constexpr int enough = 10;
  Vector3d noise_world_m = Vector3d::Constant(least_m);  ///< standard deviation of a fix, per axis
  int learned = 0;                                       ///< from so many intervals, up to enough
  TimeNs last_measured_ns = 0;                           ///< of the latest fix; 0: none
  Vector3d last_position_world_m = Vector3d::Zero();
  Vector3d last_excess_world_mps = Vector3d::Zero();  ///< its velocity minus that of the IMU alone

  bool operator==(const ScatterState&) const = default;
};

namespace scatter {

/// Learns from how far the latest three fixes are off the IMU's path, up to a constant velocity: that is what
/// an IMU gets wrong. It follows the median, to which neither a stray fix nor the jump to a wrong track
/// counts for much.
void learn(ScatterState& state, const Kinematics& body, const TimedFix& fix);

/// Takes the fix at this share of its distance from the pose, per axis.
void weigh(const Vector3d& share, const Kinematics& body, TimedFix& fix);

}  // namespace scatter
}  // namespace sonopose::estimation::documented
