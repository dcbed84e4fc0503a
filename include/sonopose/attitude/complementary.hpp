#pragma once
/// \file
/// The complementary filter (the attitude document's "Complementary Filter"): what the gyroscope predicts and
/// what accelerometer and magnetometer measure, blended.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/core/setting.hpp>

namespace sonopose::attitude {

struct ComplementarySettings {
  double alpha{};
  double alpha_step_s{};

  static constexpr std::string_view group = "attitude.complementary";
  static constexpr auto declarations() {
    using G = ComplementarySettings;
    using setting::own_setting;
    using setting::real;
    return std::tuple{
        real(own_setting, "alpha", &G::alpha, 0.999, {0.0, 1.0}, "",
             "Share of the gyroscope's prediction in the orientation; the rest is what accelerometer and "
             "magnetometer measure."),
        real(own_setting, "alpha_step_s", &G::alpha_step_s, 0.01, {1e-5, 10.0}, "s",
             "The time step that alpha is meant for; over another one it counts as often as it fits in.")};
  }
  constexpr ComplementarySettings() { setting::set_defaults(*this); }
};

template <class Number>
class BasicComplementary {
public:
  using Scalar = Number;
  using Settings = ComplementarySettings;
  static constexpr std::string_view name = "complementary";

  void reset(const Quaternion<Scalar>& q_body_to_world) {
    *this = BasicComplementary();
    q_body_to_world_ = q_body_to_world;
  }

  ///   θ ← α·(θ + ω·dt) + (1 − α)·θ_measured
  /// The document blends Euler angles, which holds near level alone, where ω is their rate. Here the
  /// predicted orientation is turned by (1 − α) of the angle between its up and the measured one, about the
  /// axis across both, and then about the vertical by (1 − α) of the angle between the level part of the
  /// field and north: for one axis the same, and right at any attitude.
  void update(const Settings& settings, const Measurement<Scalar>& measurement);

  void turn_in_world(const Vector3<Scalar>& rotation_world_rad);

  [[nodiscard]] const Quaternion<Scalar>& orientation() const { return q_body_to_world_; }

  /// As it was given: the filter learns none.
  [[nodiscard]] const Vector3<Scalar>& gyro_bias_body_radps() const { return gyro_bias_body_radps_; }
  void set_gyro_bias(const Vector3<Scalar>& bias_body_radps) { gyro_bias_body_radps_ = bias_body_radps; }

  template <class Visit>
  void for_each_field(const Visit& visit) {
    visit("q_body_to_world", q_body_to_world_);
    visit("gyro_bias_body_radps", gyro_bias_body_radps_);
  }

  bool operator==(const BasicComplementary& other) const {
    return q_body_to_world_.coeffs() == other.q_body_to_world_.coeffs() &&
           gyro_bias_body_radps_ == other.gyro_bias_body_radps_;
  }

private:
  Quaternion<Scalar> q_body_to_world_ = Quaternion<Scalar>::Identity();
  Vector3<Scalar> gyro_bias_body_radps_ = Vector3<Scalar>::Zero();
};

extern template class BasicComplementary<float>;
extern template class BasicComplementary<double>;

using Complementary = BasicComplementary<double>;

}  // namespace sonopose::attitude
