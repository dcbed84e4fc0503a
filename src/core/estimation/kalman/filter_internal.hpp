#pragma once
// Shared by the sources of Filter and State.

#include <sonopose/estimation/kalman/filter.hpp>

namespace sonopose::estimation::kalman {

inline const Vector3d gravity_world_mps2{0.0, 0.0, -standard_gravity_mps2};

/// Copies the upper triangle of the first rows and columns to the lower one.
template <int count = state_size>
void mirror_upper(StateCovariance& covariance) {
  for (int column = 0; column < count; ++column) {
    for (int row = column + 1; row < count; ++row) covariance(row, column) = covariance(column, row);
  }
}

}  // namespace sonopose::estimation::kalman
