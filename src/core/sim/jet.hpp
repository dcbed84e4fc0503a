#pragma once
/// \file
/// A number with its first and second time derivative: automatic differentiation. Motions written in jets
/// have exact velocities and accelerations.

#include <cmath>

namespace sonopose::sim {

/// A scalar function of time at one instant: value, d/dt and d²/dt².
struct Jet {
  double value = 0;
  double rate = 0;
  double acceleration = 0;

  constexpr Jet() = default;
  // A plain number is a constant, so that formulas in jets read like formulas in numbers.
  constexpr Jet(double constant) : value{constant} {}  // NOLINT(google-explicit-constructor)
  constexpr Jet(double value_in, double rate_in, double acceleration_in)
      : value{value_in}, rate{rate_in}, acceleration{acceleration_in} {}
};

constexpr Jet operator-(const Jet& a) {
  return {-a.value, -a.rate, -a.acceleration};
}

constexpr Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, a.rate + b.rate, a.acceleration + b.acceleration};
}

constexpr Jet operator-(const Jet& a, const Jet& b) {
  return a + -b;
}

/// Product by Leibniz: (ab)'' = a''b + 2a'b' + ab''.
constexpr Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.acceleration * b.value + 2.0 * a.rate * b.rate + a.value * b.acceleration};
}

/// Chain rule: a function with value f, derivative f' and second derivative f'' at x.value.
constexpr Jet chain(const Jet& x, double f, double df, double ddf) {
  return {f, df * x.rate, ddf * x.rate * x.rate + df * x.acceleration};
}

inline Jet sin(const Jet& x) {
  const double s = std::sin(x.value);
  return chain(x, s, std::cos(x.value), -s);
}

inline Jet cos(const Jet& x) {
  const double c = std::cos(x.value);
  return chain(x, c, -std::sin(x.value), -c);
}

/// Direction of the vector (x, y), which must not be zero. The rate is (x y' − y x') / (x² + y²).
inline Jet atan2(const Jet& y, const Jet& x) {
  const double square = x.value * x.value + y.value * y.value;
  const double turn = x.value * y.rate - y.value * x.rate;
  const double square_rate = 2.0 * (x.value * x.rate + y.value * y.rate);
  const double turn_rate = x.value * y.acceleration - y.value * x.acceleration;
  return {std::atan2(y.value, x.value), turn / square, (turn_rate - turn * square_rate / square) / square};
}

/// Step from 0 before x = 0 to 1 after x = 1, between them the quintic 10x³ − 15x⁴ + 6x⁵, which joins with
/// continuous second derivative.
constexpr Jet smooth_step(const Jet& x) {
  const double v = x.value;
  if (v <= 0.0) return {0.0};
  if (v >= 1.0) return {1.0};
  return chain(x, v * v * v * (10.0 + v * (-15.0 + 6.0 * v)), 30.0 * v * v * (1.0 - v) * (1.0 - v),
               60.0 * v * (1.0 - v) * (1.0 - 2.0 * v));
}

/// Integral of smooth_step: 0 before x = 0, and x − 1/2 after x = 1.
constexpr Jet smooth_start(const Jet& x) {
  const double v = x.value;
  if (v <= 0.0) return {0.0};
  if (v >= 1.0) return x - 0.5;
  return chain(x, v * v * v * v * (2.5 + v * (-3.0 + v)), v * v * v * (10.0 + v * (-15.0 + 6.0 * v)),
               30.0 * v * v * (1.0 - v) * (1.0 - v));
}

}  // namespace sonopose::sim
