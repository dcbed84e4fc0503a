#pragma once
/// \file
/// Outputs of the AHRS document in addition to the quaternion: accelerations without gravity, internal states
/// and flags. The rotation matrix is `q.toRotationMatrix()`, the angles are `geometry::euler_angles_of(q)`,
/// of the orientation in the world or in a convention (`orientation_in`).

#include <sonopose/attitude/earth_convention.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::attitude {

/// What the accelerometer measured without the 1 g of gravity, in the body's axes (m/s²).
template <class Scalar>
geometry::Vector3<Scalar> linear_acceleration_body_mps2(
    const geometry::Quaternion<Scalar>& q_body_to_world,
    const geometry::Vector3<Scalar>& specific_force_body_mps2) {
  return specific_force_body_mps2 - Scalar(standard_gravity_mps2) * geometry::up_in_body(q_body_to_world);
}

/// The same in the project's world; `vector_in` converts it to a convention.
template <class Scalar>
geometry::Vector3<Scalar> earth_acceleration_world_mps2(
    const geometry::Quaternion<Scalar>& q_body_to_world,
    const geometry::Vector3<Scalar>& specific_force_body_mps2) {
  return q_body_to_world * specific_force_body_mps2 -
         geometry::Vector3<Scalar>(0, 0, Scalar(standard_gravity_mps2));
}

/// The inputs of the rejection. The heading may also be an external one
/// (`update_external_heading`): it replaces that of the magnetometer.
template <class Scalar>
struct AhrsInternalStates {
  Scalar acceleration_error_deg = 0;   ///< from the accelerometer's up to the estimated one, 0…180
  bool accelerometer_ignored = false;  ///< by the last update that had one
  Scalar acceleration_timer = 0;       ///< 0…1; at 1 the acceleration rejection times out
  Scalar magnetic_error_deg = 0;       ///< from the magnetometer's heading to the estimated one, 0…180
  bool magnetometer_ignored = false;   ///< by the last update that had one
  Scalar magnetic_timer = 0;           ///< 0…1; at 1 the magnetic rejection times out
};

struct AhrsFlags {
  bool initialising = false;          ///< the gain is still above its final value and nothing is rejected
  bool acceleration_warning = false;  ///< the acceleration timer is above 25 %
  /// It has timed out. Form `recovery`: the accelerometer is used until it agrees. Form `seed`: initialising
  /// because of it.
  bool acceleration_timeout = false;
  bool magnetic_warning = false;  ///< the magnetic timer is above 25 %
  /// It has timed out. Form `recovery`: the magnetometer is used until it agrees. Form `seed`: the last
  /// update has set the heading.
  bool magnetic_timeout = false;
  bool over_range = false;  ///< initialising because of a rate beyond the gyroscope's range
};

}  // namespace sonopose::attitude
