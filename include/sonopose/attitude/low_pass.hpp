#pragma once
/// \file
/// A second-order low-pass filter for vectors and matrices, at variable steps.

#include <Eigen/Core>

#include <numbers>

namespace sonopose::attitude {

/// Butterworth low-pass filter y″ + √2·w·y′ + w²·y = w²·u with w = √2/time, by the implicit Euler rule, which
/// is stable at any step. For the first `time_s` it is the mean of its inputs, so it needs no initial value.
/// `Value` is an Eigen vector or matrix.
template <class Value>
struct LowPass {
  using Scalar = typename Value::Scalar;

  Value value = Value::Zero();
  Value slope = Value::Zero();  ///< per second
  Scalar age_s = 0;             ///< time covered by the inputs, up to the filter's time

  template <class Derived>
  void update(const Eigen::MatrixBase<Derived>& input, Scalar dt_s, Scalar time_s) {
    if (age_s < time_s) {
      age_s += dt_s;
      value += (age_s > 0 ? dt_s / age_s : Scalar(1)) * (input - value);
      return;
    }
    const Scalar w = std::numbers::sqrt2_v<Scalar> / time_s;
    const Scalar wdt = w * dt_s;
    const Scalar damping = 1 / (1 + std::numbers::sqrt2_v<Scalar> * wdt + wdt * wdt);
    slope = damping * (slope + (wdt * w) * (input - value));
    value += dt_s * slope;
  }

  /// Returns true once the output is no longer a plain mean.
  [[nodiscard]] bool is_settled(Scalar time_s) const { return age_s >= time_s; }

  bool operator==(const LowPass&) const = default;
};

}  // namespace sonopose::attitude
