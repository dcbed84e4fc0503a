#pragma once
/// \file
/// Quantiles of numbers, of which some may not be finite.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sonopose::statistics {

/// Value below which `share` (0…1) of the finite values lie; the lower one if it falls between two. 0 without
/// finite values.
inline double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace sonopose::statistics
