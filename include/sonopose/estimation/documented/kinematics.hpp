#pragma once
/// \file
/// The kinematic state shared by the stages, with the inertial path.

#include <sonopose/estimation/documented/history.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::estimation::documented {

/// Position, velocity and the sums of their corrections by fixes and headings.
///
/// The velocity is v = n + c: n is integrated from the IMU, c is the sum of all corrections by fixes. A
/// correction applies to the past as well. A comparison with a past interval therefore uses the mean of n
/// over the interval plus the current c. The same applies to yaw. Otherwise delayed fixes would correct the
/// same error again.
struct Kinematics {
  TimeNs time_ns = 0;  ///< time of the latest IMU sample; 0 before the first
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Vector3d velocity_corrections_world_mps = Vector3d::Zero();  ///< c
  Vector3d displacement_world_m = Vector3d::Zero();            ///< ∫n dt
  double yaw_corrections_rad = 0;
  Vector3d acceleration_world_mps2 =
      Vector3d::Zero();  ///< measured acceleration without gravity, before any gate
  Vector3d angular_velocity_body_radps = Vector3d::Zero();
  InertialHistory history;

  [[nodiscard]] bool started() const { return time_ns != 0; }

  /// Adds a correction to the velocity.
  void correct_velocity(const Vector3d& change_world_mps) {
    velocity_world_mps += change_world_mps;
    velocity_corrections_world_mps += change_world_mps;
  }

  /// Displacement from `from_ns` to `to_ns` by the IMU with the current corrections, extrapolated at the
  /// current velocity beyond the latest sample. Empty if the history begins later.
  [[nodiscard]] std::optional<Vector3d> displacement_between(TimeNs from_ns, TimeNs to_ns) const;

  /// Yaw at `then_ns` with the current corrections.
  [[nodiscard]] std::optional<double> yaw_at(TimeNs then_ns) const;

  bool operator==(const Kinematics&) const = default;
};

}  // namespace sonopose::estimation::documented
