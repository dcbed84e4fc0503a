#pragma once
/// \file
/// The orientation half of the strapdown document (equations 3 and 4) as a filter: the gyroscope alone, which
/// nothing corrects.

#include <sonopose/attitude/filter.hpp>

namespace sonopose::attitude {

/// It has none.
struct GyroSettings {};

template <class Number>
class BasicGyro {
public:
  using Scalar = Number;
  using Settings = GyroSettings;
  static constexpr std::string_view name = "gyro";

  void reset(const Quaternion<Scalar>& q_body_to_world) {
    *this = BasicGyro();
    q_body_to_world_ = q_body_to_world;
  }

  /// q ← q ⊗ exp(ω·dt): the right-hand product, where the document writes the left.
  void update(const Settings& /*settings*/, const Measurement<Scalar>& measurement) {
    const Vector3<Scalar> rate_body_radps = measurement.angular_velocity_body_radps - gyro_bias_body_radps_;
    q_body_to_world_ =
        (q_body_to_world_ * math::rotation_by(rate_body_radps * measurement.dt_s)).normalized();
  }

  void turn_in_world(const Vector3<Scalar>& rotation_world_rad) {
    q_body_to_world_ = (math::rotation_by(rotation_world_rad) * q_body_to_world_).normalized();
  }

  [[nodiscard]] const Quaternion<Scalar>& orientation() const { return q_body_to_world_; }
  [[nodiscard]] const Vector3<Scalar>& gyro_bias_body_radps() const { return gyro_bias_body_radps_; }
  void set_gyro_bias(const Vector3<Scalar>& bias_body_radps) { gyro_bias_body_radps_ = bias_body_radps; }

  template <class Visit>
  void for_each_field(const Visit& visit) {
    visit("q_body_to_world", q_body_to_world_);
    visit("gyro_bias_body_radps", gyro_bias_body_radps_);
  }

  bool operator==(const BasicGyro& other) const {
    return q_body_to_world_.coeffs() == other.q_body_to_world_.coeffs() &&
           gyro_bias_body_radps_ == other.gyro_bias_body_radps_;
  }

private:
  Quaternion<Scalar> q_body_to_world_ = Quaternion<Scalar>::Identity();
  Vector3<Scalar> gyro_bias_body_radps_ = Vector3<Scalar>::Zero();
};

using Gyro = BasicGyro<double>;

}  // namespace sonopose::attitude
