#pragma once
// Medians over rounds and their confidence.

#include <sonopose/statistics/quantile.hpp>

#include <vector>

namespace sonopose::benchmarks {

/// Returns the middle value; the mean of the two middle ones for an even count. NaN for no values.
double median(std::vector<double> values);

/// A confidence interval of the population median: two order statistics, selected by the binomial
/// distribution. Makes no assumption about the distribution of the values.
struct MedianInterval {
  double lower = 0;
  double upper = 0;
  double confidence = 0;  ///< smallest value of at least 0.95 in 0…1; lower for fewer than six rounds
};
MedianInterval median_interval(std::vector<double> values);

}  // namespace sonopose::benchmarks
