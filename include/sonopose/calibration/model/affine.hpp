#pragma once
/// \file
/// What a calibration does to one vector of a sensor: a number of bytes without pointers, made once from
/// settings, then used for every sample.

#include <Eigen/Core>

#include <array>

namespace sonopose::calibration {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// v ↦ A·(v − b) − h. Where that is v itself, nothing is computed, so that not even a sign of zero changes.
class Affine {
public:
  /// v ↦ v.
  Affine();

  Affine(const Matrix3d& matrix, const Vector3d& before, const Vector3d& after);

  [[nodiscard]] Vector3d operator()(const Vector3d& vector) const noexcept;

  /// The v that becomes `vector`. Not finite where the matrix cannot be inverted.
  [[nodiscard]] Vector3d inverse_of(const Vector3d& vector) const noexcept;

  /// The same, then turned by `rotation`.
  [[nodiscard]] Affine turned_by(const Matrix3d& rotation) const;

  bool operator==(const Affine&) const = default;

private:
  std::array<double, 9> matrix_{};  ///< by columns
  std::array<double, 3> before_{};
  std::array<double, 3> after_{};
  bool does_nothing_;
};

}  // namespace sonopose::calibration
