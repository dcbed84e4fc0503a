#pragma once
/// \file
/// Items 3, 7, 8 and 26–28: the velocity correction by fixes.

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

/// An earlier good fix.
struct PastFix {
  TimeNs measured_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();

  bool operator==(const PastFix&) const = default;
};

/// Latest good fixes, newest first, from which the next velocity is measured.
struct VelocityState {
  static constexpr int capacity = 8;
  std::array<PastFix, capacity> fixes;
  int count = 0;
  std::array<PastFix, capacity> rivals;  ///< latest outliers that agree with each other, newest first
  int rival_count = 0;
  int velocities = 0;  ///< velocity corrections of this run, up to averaged_velocities

  /// Number of corrections after which the velocity no longer averages the first velocities of the run.
  static constexpr int averaged_velocities = 7;
  [[nodiscard]] bool settled() const { return velocities >= averaged_velocities; }
  void settle() { velocities = averaged_velocities; }
  void unsettle() { velocities = 0; }

  bool operator==(const VelocityState&) const = default;
};

/// Velocity between two fixes, and the IMU's mean over the same interval.
struct FixVelocity {
  Vector3d ultrasonic_world_mps = Vector3d::Zero();
  Vector3d inertial_world_mps = Vector3d::Zero();
  Vector3d displacement_world_m = Vector3d::Zero();  ///< between the two fixes
  double interval_s = 0;                             ///< between the two fixes
  double bend_m =
      0;  ///< distance to the linear extrapolation of the two previous fixes; infinite without them
  double agreement =
      1;  ///< agreement of the two fixes along the IMU's path: the weight (item 13) of their distance to it
  bool by_rivals = false;             ///< true if measured between two outliers that agree with each other
  Vector3d share = Vector3d::Ones();  ///< share of each axis that counts (scatter)
  double usual_fixes = 1;  ///< number of fixes at the wanted interval that would have come since the latest
};

/// Velocity correction by one fix.
struct VelocityChange {
  Vector3d change_world_mps = Vector3d::Zero();
  double share = 1;         ///< corrected share of the difference between the two velocities
  std::uint32_t flags = 0;  ///< fix_snapped_over, fix_snapped_under
};

namespace velocity {

/// Share that so many corrections with this share each correct together.
[[nodiscard]] double share_of_several(double share, double fixes);

/// Begins a run of fixes with `fix`.
void restart(VelocityState& state, const TimedFix& fix, bool velocity_known);

/// Measures the velocity from an earlier good fix to this one, or between outliers that agree with each
/// other. Stores this fix with its kind. Empty if no earlier fix has a suitable distance in time. Also empty
/// at the first fix of a new track: the step between two tracks is no motion.
[[nodiscard]] std::optional<FixVelocity> measure(const VelocitySettings& settings, VelocityState& state,
                                                 const Kinematics& body, const TimedFix& fix,
                                                 const FixAssessment& assessment);

/// Corrects the velocity: v += blend · reliability · (v_us − mean v_imu), or completely if a snap applies.
/// The first velocities of a run are averaged. Outliers that agree with each other count like other fixes: on
/// a wrong track the body moves as on the right one.
VelocityChange correct(const VelocitySettings& settings, VelocityState& state, Kinematics& body,
                       const FixVelocity& measured, const FixAssessment& assessment);

/// Sets the velocity to the measured one, at the second fix of a run. Returns the change.
Vector3d initialise(VelocityState& state, Kinematics& body, const FixVelocity& measured);

}  // namespace velocity
}  // namespace sonopose::estimation::documented
