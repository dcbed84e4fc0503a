#pragma once
/// \file
/// A number with its first four time derivatives: if the attitude follows from the acceleration, the angular
/// acceleration needs the fourth derivative of the position.

#include "sim/jet.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace sonopose::sim {

/// A scalar function of time near one instant, f(t + h) = Σ c[k] hᵏ.
struct Taylor {
  static constexpr std::size_t order = 4;
  std::array<double, order + 1> c{};

  static constexpr Taylor constant(double value) { return {{value}}; }

  /// Value, velocity and acceleration.
  [[nodiscard]] constexpr Jet jet() const { return {c[0], c[1], 2.0 * c[2]}; }
  /// Second derivative, with its own first two.
  [[nodiscard]] constexpr Jet second_derivative() const { return {2.0 * c[2], 6.0 * c[3], 24.0 * c[4]}; }
};

constexpr Taylor operator+(Taylor a, const Taylor& b) {
  for (std::size_t k = 0; k <= Taylor::order; ++k) a.c[k] += b.c[k];
  return a;
}

/// Truncated Cauchy product.
constexpr Taylor operator*(const Taylor& a, const Taylor& b) {
  Taylor product;
  for (std::size_t k = 0; k <= Taylor::order; ++k) {
    for (std::size_t i = 0; i <= k; ++i) product.c[k] += a.c[i] * b.c[k - i];
  }
  return product;
}

/// The oscillation amplitude · sin(rate · time + phase).
inline Taylor sine(double amplitude, double rate_radps, double phase_rad, double time_s) {
  const double angle = rate_radps * time_s + phase_rad;
  const double s = amplitude * std::sin(angle);
  const double c = amplitude * std::cos(angle);
  const double r = rate_radps;
  return {{s, r * c, -r * r * s / 2.0, -r * r * r * c / 6.0, r * r * r * r * s / 24.0}};
}

/// Step from 0 before `begin_s` to 1 after begin + duration, between them the polynomial of degree 9 that
/// joins with continuous fourth derivative.
inline Taylor smoother_step(double time_s, double begin_s, double duration_s) {
  const double x = (time_s - begin_s) / duration_s;
  if (x <= 0.0) return Taylor::constant(0.0);
  if (x >= 1.0) return Taylor::constant(1.0);
  const Taylor progress{{x, 1.0 / duration_s}};
  Taylor sum = Taylor::constant(70.0);
  for (const double coefficient : {-315.0, 540.0, -420.0, 126.0}) {
    sum = sum * progress + Taylor::constant(coefficient);
  }
  const Taylor square = progress * progress;
  return sum * square * square * progress;
}

}  // namespace sonopose::sim
