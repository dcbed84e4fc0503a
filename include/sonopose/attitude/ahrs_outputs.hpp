#pragma once
/// \file
/// Outputs of the AHRS document besides the quaternion: accelerations without gravity, internal states and
/// flags. The rotation matrix is `q.toRotationMatrix()`. The Euler angles are `geometry::euler_angles_of(q)`,
/// in the world or in a convention (`orientation_in`).

#include <sonopose/attitude/earth_convention.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::attitude {

/// Measured acceleration without gravity in body axes (m/s²).
template <class Scalar>
geometry::Vector3<Scalar> linear_acceleration_body_mps2(
    const geometry::Quaternion<Scalar>& q_body_to_world,
    const geometry::Vector3<Scalar>& specific_force_body_mps2) {
  return specific_force_body_mps2 - Scalar(standard_gravity_mps2) * geometry::up_in_body(q_body_to_world);
}

/// Measured acceleration without gravity in the project's world. `vector_in` converts it to a convention.
template <class Scalar>
geometry::Vector3<Scalar> earth_acceleration_world_mps2(
    const geometry::Quaternion<Scalar>& q_body_to_world,
    const geometry::Vector3<Scalar>& specific_force_body_mps2) {
  return q_body_to_world * specific_force_body_mps2 -
         geometry::Vector3<Scalar>(0, 0, Scalar(standard_gravity_mps2));
}

/// Inputs of the rejection. An external heading (`update_external_heading`) replaces the magnetometer's.
template <class Scalar>
struct AhrsInternalStates {
  Scalar acceleration_error_deg = 0;   ///< angle from the accelerometer's up to the estimated one, 0…180
  bool accelerometer_ignored = false;  ///< true if the last update with an accelerometer ignored it
  Scalar acceleration_timer = 0;       ///< 0…1; at 1 the acceleration rejection times out
  Scalar magnetic_error_deg = 0;      ///< angle from the magnetometer's heading to the estimated one, 0…180
  bool magnetometer_ignored = false;  ///< true if the last update with a magnetometer ignored it
  Scalar magnetic_timer = 0;          ///< 0…1; at 1 the magnetic rejection times out
};

struct AhrsFlags {
  bool initialising = false;          ///< the gain is still above its final value and nothing is rejected
  bool acceleration_warning = false;  ///< the acceleration timer is above 25 %
  /// The acceleration rejection has timed out. Form `recovery`: the accelerometer is used until it agrees.
  /// Form `seed`: the filter initialises because of it.
  bool acceleration_timeout = false;
  bool magnetic_warning = false;  ///< the magnetic timer is above 25 %
  /// The magnetic rejection has timed out. Form `recovery`: the magnetometer is used until it agrees. Form
  /// `seed`: the last update has set the heading.
  bool magnetic_timeout = false;
  bool over_range = false;  ///< initialising because of a rate beyond the gyroscope's range
};

}  // namespace sonopose::attitude
