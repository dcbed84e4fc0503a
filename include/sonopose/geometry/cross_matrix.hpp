#pragma once
/// \file
/// The cross product as a matrix.

#include <Eigen/Core>

namespace sonopose::geometry {

/// The matrix [v]× with [v]× w = v × w.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace sonopose::geometry
