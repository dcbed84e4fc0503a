#pragma once
/// \file
/// The state of a filter that consists only of an orientation and a gyroscope offset.

#include <sonopose/attitude/filter.hpp>

namespace sonopose::attitude {

/// Implements the concept Filter, except for the update.
template <class Number>
class IntegratedAttitude {
public:
  using Scalar = Number;

  void reset(const Quaternion<Scalar>& q_body_to_world) {
    q_body_to_world_ = q_body_to_world;
    gyro_bias_body_radps_.setZero();
  }

  void turn_in_world(const Vector3<Scalar>& rotation_world_rad) {
    q_body_to_world_ = (geometry::rotation_by(rotation_world_rad) * q_body_to_world_).normalized();
  }

  [[nodiscard]] const Quaternion<Scalar>& orientation() const { return q_body_to_world_; }
  [[nodiscard]] const Vector3<Scalar>& gyro_bias_body_radps() const { return gyro_bias_body_radps_; }
  void set_gyro_bias(const Vector3<Scalar>& bias_body_radps) { gyro_bias_body_radps_ = bias_body_radps; }

  template <class Visit>
  void for_each_field(const Visit& visit) {
    visit("q_body_to_world", q_body_to_world_);
    visit("gyro_bias_body_radps", gyro_bias_body_radps_);
  }

  bool operator==(const IntegratedAttitude& other) const {
    return q_body_to_world_.coeffs() == other.q_body_to_world_.coeffs() &&
           gyro_bias_body_radps_ == other.gyro_bias_body_radps_;
  }

protected:
  /// q ← q ⊗ exp(ω·dt), with ω in body axes. The strapdown document multiplies from the left; body rates and
  /// a body-to-world quaternion require the right.
  void turn_in_body(const Vector3<Scalar>& rotation_body_rad) {
    q_body_to_world_ = (q_body_to_world_ * geometry::rotation_by(rotation_body_rad)).normalized();
  }

  Quaternion<Scalar> q_body_to_world_ = Quaternion<Scalar>::Identity();
  Vector3<Scalar> gyro_bias_body_radps_ = Vector3<Scalar>::Zero();
};

}  // namespace sonopose::attitude
