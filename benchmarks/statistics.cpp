#include "statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::benchmarks {

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

MedianInterval median_interval(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size();
  // The number of values below the true median is binomial with p = 1/2. The interval from the k-th lowest to
  // the k-th highest misses it with twice the probability of fewer than k.
  double below = std::pow(0.5, static_cast<double>(count));  // probability of exactly k
  double missed = 2.0 * below;
  MedianInterval interval{values.front(), values.back(), 1.0 - missed};
  for (std::size_t k = 1; 2 * k + 1 < count; ++k) {
    below *= static_cast<double>(count - k + 1) / static_cast<double>(k);
    missed += 2.0 * below;
    if (1.0 - missed < 0.95) break;
    interval = {values[k], values[count - 1 - k], 1.0 - missed};
  }
  return interval;
}

}  // namespace sonopose::benchmarks
