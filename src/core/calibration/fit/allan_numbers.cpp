#include "calibration/fit/allan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::calibration::fit {
namespace {

/// Points known well enough to read a slope.
std::span<const AllanPoint> reliable_points(std::span<const AllanPoint> curve) {
  constexpr double max_relative_error = 0.16;
  std::size_t count = 0;
  while (count < curve.size() && curve[count].relative_error <= max_relative_error) ++count;
  return curve.first(count);
}

/// A run of neighbouring points.
struct PointRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Slope on logarithmic scales around a point, from a quarter of a decade before it to one after it; NaN near
/// the endpoints.
double slope_at(std::span<const AllanPoint> curve, std::size_t place) {
  const double half = std::pow(10.0, 0.25);
  std::size_t before = place;
  while (before > 0 && curve[before].tau_s * half > curve[place].tau_s) --before;
  std::size_t behind = place;
  while (behind + 1 < curve.size() && curve[behind].tau_s < curve[place].tau_s * half) ++behind;
  // Clusters are whole numbers of samples, so the first ones lie far apart.
  constexpr double min_span_share = 0.75;
  const double decades = std::log10(curve[behind].tau_s / curve[before].tau_s);
  if (decades < 0.5 * min_span_share) return std::numeric_limits<double>::quiet_NaN();
  return std::log10(curve[behind].deviation / curve[before].deviation) / decades;
}

/// Longest run of points with about this slope; empty if shorter than half a decade.
PointRange longest_with_slope(std::span<const AllanPoint> curve, double wanted) {
  constexpr double tolerance = 0.15;
  constexpr double min_ratio = 3.1622776601683795;  // half a decade
  PointRange longest;
  double max_ratio = min_ratio;
  for (std::size_t begin = 0; begin < curve.size(); ++begin) {
    std::size_t end = begin;
    while (end < curve.size() && std::abs(slope_at(curve, end) - wanted) <= tolerance) ++end;
    if (end == begin) continue;
    const double ratio = curve[end - 1].tau_s / curve[begin].tau_s;
    if (ratio >= max_ratio) {
      max_ratio = ratio;
      longest = {begin, end};
    }
    begin = end;
  }
  return longest;
}

/// Value at `tau_s` of the line with this slope that best fits that range. Points are weighted by their
/// accuracy.
std::optional<double> line_at(std::span<const AllanPoint> curve, double slope, double tau_s) {
  const PointRange range = longest_with_slope(curve, slope);
  if (range.begin == range.end) return std::nullopt;
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const double weight = 1.0 / (curve[k].relative_error * curve[k].relative_error);
    sum += weight * (std::log(curve[k].deviation) - slope * std::log(curve[k].tau_s));
    weights += weight;
  }
  return std::exp(sum / weights + slope * std::log(tau_s));
}

/// Lowest point, unless the curve merely falls there as white noise does.
std::optional<AllanPoint> floor_of(std::span<const AllanPoint> curve, std::optional<double> noise_density) {
  constexpr double min_slope = -0.25;
  constexpr double max_std_errors = 3.0;
  if (curve.empty()) return std::nullopt;
  const auto lowest = std::min_element(
      curve.begin(), curve.end(), [](const auto& a, const auto& b) { return a.deviation < b.deviation; });
  const double white = noise_density.value_or(0.0) / std::sqrt(lowest->tau_s);
  if (lowest->deviation * (1.0 - max_std_errors * lowest->relative_error) < white) return std::nullopt;
  // The slope is unknown at the end of the record: the curve has not left the floor there.
  const double slope = slope_at(curve, static_cast<std::size_t>(lowest - curve.begin()));
  if (!(slope >= min_slope)) return std::nullopt;
  return *lowest;
}

}  // namespace

AllanNumbers allan_numbers(std::span<const AllanPoint> curve) {
  constexpr double flicker_factor = 0.664;  // √(2·ln 2/π): ratio of a flat curve to the instability
  const auto points = reliable_points(curve);
  AllanNumbers numbers;
  numbers.noise_density = line_at(points, -0.5, 1.0);
  numbers.rate_random_walk = line_at(points, 0.5, 3.0);
  if (const auto floor = floor_of(points, numbers.noise_density)) {
    numbers.bias_instability = floor->deviation / flicker_factor;
    numbers.bias_instability_tau_s = floor->tau_s;
  }
  return numbers;
}

}  // namespace sonopose::calibration::fit
