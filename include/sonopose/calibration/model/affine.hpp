#pragma once
/// \file
/// The calibration of one vector of a sensor: a value without pointers, made once from settings, then used
/// for every sample.

#include <Eigen/Core>

#include <array>

namespace sonopose::calibration {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The map v ↦ A·(v − b) − h. The identity computes nothing, so that even a negative zero keeps its sign.
class Affine {
public:
  /// Constructs the identity.
  Affine();

  Affine(const Matrix3d& matrix, const Vector3d& before, const Vector3d& after);

  [[nodiscard]] Vector3d operator()(const Vector3d& vector) const noexcept;

  /// Returns the v that maps to `vector`; not finite if the matrix is singular.
  [[nodiscard]] Vector3d inverse_of(const Vector3d& vector) const noexcept;

  /// This map followed by `rotation`.
  [[nodiscard]] Affine turned_by(const Matrix3d& rotation) const;

  bool operator==(const Affine&) const = default;

private:
  std::array<double, 9> matrix_{};  ///< matrix in column-major order
  std::array<double, 3> before_{};
  std::array<double, 3> after_{};
  bool does_nothing_;
};

}  // namespace sonopose::calibration
