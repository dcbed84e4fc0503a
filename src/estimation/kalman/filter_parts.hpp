#pragma once
// What the sources of Filter share.

#include <sonopose/estimation/kalman/filter.hpp>

namespace sonopose::estimation::kalman {

/// Copies the upper triangle to the lower one.
inline void mirror_upper(StateCovariance& covariance) {
  for (int column = 0; column < state_size; ++column) {
    for (int row = column + 1; row < state_size; ++row) covariance(row, column) = covariance(column, row);
  }
}

}  // namespace sonopose::estimation::kalman
