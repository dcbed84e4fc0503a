#pragma once
/// \file
/// First-order lags.

#include <cmath>

namespace sonopose::estimation::documented {

/// The share of a step that a first-order lag follows in `time_constants`, the time divided by its time
/// constant: 1 − e^(−x). It is not negative.
inline double lag_share(double time_constants) {
  const double x = time_constants;
  if (!(x < 0.1)) return -std::expm1(-x);
  // The series, exact to rounding. Each IMU sample needs it, and finds the library's function out of the
  // cache.
  double share = 1.0;
  for (int n = 11; n >= 2; --n) share = 1.0 - share * x / n;
  return share * x;
}

}  // namespace sonopose::estimation::documented
