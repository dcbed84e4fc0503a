#pragma once
/// \file
/// First-order lags.

#include <cmath>

namespace sonopose::estimation::documented {

/// Share of a step that a first-order lag follows: 1 − e^(−x). `time_constants`, here x ≥ 0, is the time
/// divided by the time constant.
inline double lag_share(double time_constants) {
  const double x = time_constants;
  if (!(x < 0.1)) return -std::expm1(-x);
  // A series, exact to rounding: every IMU sample needs it, and the library's function would not be in the
  // cache.
  double share = 1.0;
  for (int n = 11; n >= 2; --n) share = 1.0 - share * x / n;
  return share * x;
}

}  // namespace sonopose::estimation::documented
