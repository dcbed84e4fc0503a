#pragma once
// Medians over rounds and how sure they are.

#include <sonopose/statistics/quantile.hpp>

#include <cstddef>
#include <vector>

namespace sonopose::benchmarks {

/// The middle value; the mean of the two middle ones where their number is even. NaN for none.
double median(std::vector<double> values);

/// Where the median of what the rounds are drawn from lies. Two order statistics of the rounds, chosen by the
/// binomial distribution alone: nothing is assumed of how the values are spread.
struct MedianInterval {
  double least = 0;
  double most = 0;
  double confidence = 0;  ///< 0…1; the least that is 0.95 or more, or, of fewer than six rounds, all there is
};
MedianInterval median_interval(std::vector<double> values);

}  // namespace sonopose::benchmarks
