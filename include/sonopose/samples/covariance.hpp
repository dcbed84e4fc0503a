#pragma once
/// \file
/// A covariance as its upper triangle, as transmitted and recorded.

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sonopose {

/// A symmetric N × N covariance. A negative variance is unknown; its covariances are then zero.
template <int N>
class Covariance {
public:
  static constexpr std::size_t element_count = N * (N + 1) / 2;
  static constexpr double unknown = -1.0;

  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  /// Sets all variances to unknown.
  constexpr Covariance() {
    for (int i = 0; i < N; ++i) set(i, i, unknown);
  }

  /// Takes the upper triangle, row by row.
  constexpr explicit Covariance(const std::array<double, element_count>& elements) : elements_(elements) {}

  static Covariance from_diagonal(const Vector& variances) {
    Covariance result;
    for (int i = 0; i < N; ++i) result.set(i, i, variances[i]);
    return result;
  }

  /// Reads the upper triangle of `matrix`.
  static Covariance from_matrix(const Matrix& matrix) {
    Covariance result;
    for (int row = 0; row < N; ++row) {
      for (int column = row; column < N; ++column) result.set(row, column, matrix(row, column));
    }
    return result;
  }

  [[nodiscard]] constexpr double at(int row, int column) const { return elements_[index(row, column)]; }

  /// Sets (row, column) and (column, row).
  constexpr void set(int row, int column, double value) { elements_[index(row, column)] = value; }

  [[nodiscard]] constexpr bool is_known(int i) const { return at(i, i) >= 0.0; }

  /// Standard deviation of component i. NaN: unknown.
  [[nodiscard]] double std_dev(int i) const {
    return is_known(i) ? std::sqrt(at(i, i)) : std::numeric_limits<double>::quiet_NaN();
  }

  [[nodiscard]] Matrix matrix() const {
    Matrix result;
    for (int row = 0; row < N; ++row) {
      for (int column = 0; column < N; ++column) result(row, column) = at(row, column);
    }
    return result;
  }

  /// Upper triangle, row by row.
  [[nodiscard]] constexpr const std::array<double, element_count>& elements() const { return elements_; }

  bool operator==(const Covariance&) const = default;

private:
  static constexpr std::size_t index(int row, int column) {
    const int first = std::min(row, column);
    const int second = std::max(row, column);
    return static_cast<std::size_t>(first * N - first * (first - 1) / 2 + second - first);
  }

  std::array<double, element_count> elements_{};
};

}  // namespace sonopose
