#pragma once
// What the sources of Filter share.

#include <sonopose/estimation/kalman/filter.hpp>

namespace sonopose::estimation::kalman {

/// [v]×
inline Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Copies the upper triangle to the lower one.
inline void mirror_upper(StateCovariance& covariance) {
  for (int column = 0; column < state_size; ++column) {
    for (int row = column + 1; row < state_size; ++row) covariance(row, column) = covariance(column, row);
  }
}

}  // namespace sonopose::estimation::kalman
