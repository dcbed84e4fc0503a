#pragma once
/// \file
/// The moving body that the stages share: where it is, and the inertial path behind it.

#include <sonopose/samples/samples.hpp>
#include <sonopose/estimation/documented/history.hpp>

#include <optional>

namespace sonopose::estimation::documented {

/// Position, velocity and the sums of what fixes and headings have changed in them.
///
/// The velocity is v = n + c: n has been integrated from the IMU, c is the sum of all corrections by fixes. A
/// correction that is made now would have been due in the past as well, so a comparison with a past interval
/// uses the mean of n over it plus today's c. The same holds for yaw. Without that, an error that has been
/// corrected already would be corrected again by the fixes that were under way meanwhile.
struct Kinematics {
  TimeNs time_ns = 0;  ///< of the latest IMU sample; 0 before the first
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Vector3d velocity_corrections_world_mps = Vector3d::Zero();  ///< c
  Vector3d displacement_world_m = Vector3d::Zero();            ///< ∫n dt
  double yaw_corrections_rad = 0;
  Vector3d acceleration_world_mps2 = Vector3d::Zero();  ///< measured, gravity off, before any gate
  Vector3d angular_velocity_body_radps = Vector3d::Zero();
  InertialHistory history;

  [[nodiscard]] bool started() const { return time_ns != 0; }

  /// Changes the velocity by a fix's correction.
  void correct_velocity(const Vector3d& change_world_mps) {
    velocity_world_mps += change_world_mps;
    velocity_corrections_world_mps += change_world_mps;
  }

  /// How far the body moved from `from_ns` to `to_ns` by the IMU, with today's corrections; a time ahead of
  /// the latest sample is reached at the present velocity. Empty where the history does not reach back so
  /// far.
  [[nodiscard]] std::optional<Vector3d> moved(TimeNs from_ns, TimeNs to_ns) const;

  /// Yaw at `then_ns`, with today's corrections.
  [[nodiscard]] std::optional<double> yaw_at(TimeNs then_ns) const;

  bool operator==(const Kinematics&) const = default;
};

}  // namespace sonopose::estimation::documented
