#pragma once
/// \file
/// Items 3, 7, 8 and 26–28: how the velocity follows the fixes.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/trust.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <cstdint>
#include <optional>

namespace sonopose::estimation::documented {

using settings::VelocitySettings;

/// One good fix of the past.
struct PastFix {
  TimeNs measured_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();

  bool operator==(const PastFix&) const = default;
};

/// The latest good fixes, newest first, from which the next velocity can be measured.
struct VelocityState {
  static constexpr int capacity = 8;
  std::array<PastFix, capacity> fixes;
  int count = 0;
  int velocities =
      0;  ///< that the run has corrected the velocity by; none counts for more than the first few

  /// Whether the velocity is known as well as it will be, and not still averaged over the run's first ones.
  static constexpr int enough_velocities = 7;
  [[nodiscard]] bool settled() const { return velocities >= enough_velocities; }
  void settle() { velocities = enough_velocities; }
  void unsettle() { velocities = 0; }

  bool operator==(const VelocityState&) const = default;
};

/// The velocity between two fixes, and the IMU's mean over the same interval.
struct FixVelocity {
  Vector3d ultrasonic_world_mps = Vector3d::Zero();
  Vector3d inertial_world_mps = Vector3d::Zero();
  Vector3d displacement_world_m = Vector3d::Zero();  ///< between the two fixes
  double interval_s = 0;                             ///< between the two fixes
  double bend_m = 0;  ///< from the straight continuation of the two fixes before; infinite without them
};

/// What a fix did to the velocity.
struct VelocityChange {
  Vector3d change_world_mps = Vector3d::Zero();
  double share = 1;         ///< of the difference between the two velocities that was corrected
  std::uint32_t flags = 0;  ///< fix_snapped_over, fix_snapped_under
};

namespace velocity {

/// Begins a run of fixes with this one, of a body whose velocity is known already or not.
void restart(VelocityState& state, const TimedFix& fix, bool velocity_known);

/// Measures the velocity from an earlier good fix to this one and remembers this one where it is good, that
/// is no outlier, or one of a convergence that is forced. Empty where there is none at the right distance in
/// time, or where the track begins anew: from the old track to the new one nothing has moved.
[[nodiscard]] std::optional<FixVelocity> measure(const VelocitySettings& settings, VelocityState& state,
                                                 const Kinematics& body, const TimedFix& fix,
                                                 const FixAssessment& assessment);

/// Corrects the velocity: v += blend · reliability · (v_us − mean v_imu), or at once where a snap applies.
/// The first velocities of a run are averaged.
VelocityChange correct(const VelocitySettings& settings, VelocityState& state, Kinematics& body,
                       const FixVelocity& measured, const FixAssessment& assessment);

/// Takes the measured velocity outright: the second fix after stale mode.
Vector3d adopt(VelocityState& state, Kinematics& body, const FixVelocity& measured);

}  // namespace velocity
}  // namespace sonopose::estimation::documented
