#pragma once
/// \file
/// What a calibration does to one vector of a sensor: a number of bytes without pointers, made once from
/// settings, then used for every sample.

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <array>

namespace sonopose::calibration {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// v ↦ A·(v − b) − h. Where that is v itself, nothing is computed, so that not even a sign of zero changes.
class Affine {
public:
  /// v ↦ v.
  Affine() : Affine(Matrix3d::Identity(), Vector3d::Zero(), Vector3d::Zero()) {}

  Affine(const Matrix3d& matrix, const Vector3d& before, const Vector3d& after)
      : does_nothing_(matrix == Matrix3d::Identity() && before.isZero(0.0) && after.isZero(0.0)) {
    std::copy_n(matrix.data(), 9, matrix_.begin());
    std::copy_n(before.data(), 3, before_.begin());
    std::copy_n(after.data(), 3, after_.begin());
  }

  [[nodiscard]] Vector3d operator()(const Vector3d& vector) const noexcept {
    if (does_nothing_) return vector;
    return matrix() * (vector - before()) - after();
  }

  /// What becomes of it is `vector`. Not finite where the matrix cannot be inverted.
  [[nodiscard]] Vector3d inverse_of(const Vector3d& vector) const noexcept {
    return matrix().inverse() * (vector + after()) + before();
  }

  /// The same, then turned by `rotation`.
  [[nodiscard]] Affine turned_by(const Matrix3d& rotation) const {
    return {rotation * matrix(), before(), rotation * after()};
  }

  bool operator==(const Affine&) const = default;

private:
  using Matrix = Eigen::Map<const Matrix3d>;
  using Vector = Eigen::Map<const Vector3d>;

  [[nodiscard]] Matrix matrix() const noexcept { return Matrix(matrix_.data()); }
  [[nodiscard]] Vector before() const noexcept { return Vector(before_.data()); }
  [[nodiscard]] Vector after() const noexcept { return Vector(after_.data()); }

  std::array<double, 9> matrix_{};  ///< by columns
  std::array<double, 3> before_{};
  std::array<double, 3> after_{};
  bool does_nothing_;
};

}  // namespace sonopose::calibration
