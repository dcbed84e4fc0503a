#pragma once
/// \file
/// The noise of the fixes, learned per axis. An axis that is much noisier than item 13 counts less (trust).
/// Beacons that hang at one height measure the height badly.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::documented {

struct ScatterState {
  static constexpr double min_m = 0.01;
  static constexpr int samples_to_learn = 10;
  Vector3d noise_world_m = Vector3d::Constant(min_m);  ///< standard deviation of a fix, per axis
  int learned = 0;              ///< number of intervals learned from, up to samples_to_learn
  TimeNs last_measured_ns = 0;  ///< measurement time of the latest fix; 0: none
  Vector3d last_position_world_m = Vector3d::Zero();
  Vector3d last_excess_world_mps =
      Vector3d::Zero();  ///< velocity between the latest fixes minus that of the IMU alone

  bool operator==(const ScatterState&) const = default;
};

namespace scatter {

/// Learns from the distance of the latest three fixes to the IMU's path, up to a constant velocity, which an
/// IMU gets wrong. The noise follows the median, so that a stray fix or the jump to a wrong track counts
/// little.
void learn(ScatterState& state, const Kinematics& body, const TimedFix& fix);

/// Moves the fix to this share of its distance from the pose, per axis.
void scale_innovation(const Vector3d& share, const Kinematics& body, TimedFix& fix);

}  // namespace scatter
}  // namespace sonopose::estimation::documented
