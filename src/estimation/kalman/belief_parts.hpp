#pragma once
// What the sources of Belief share: thresholds, the noise models, and the loop over all filters.

#include <sonopose/estimation/kalman/belief.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace sonopose::estimation::kalman {

inline constexpr double full_weight_below = 7.8;  // χ², 3 degrees of freedom: 5 % are above
inline constexpr double rejected_above = 30.0;
inline constexpr TimeNs heading_kept_ns = 500'000'000;  // for a start
inline constexpr double former_s = 8.0;                 // for which a track that was given up is kept
inline constexpr int few_fixes = 2;                     // enough to distinguish a rest from a smooth cruise

inline constexpr std::array<ProcessNoise, model_count> models{
    ProcessNoise{}, ProcessNoise{.gyro_radps_rthz = 12 * 2e-4, .gyro_bias_radps_rts = 1e-3},
    ProcessNoise{.accel_mps2_rthz = 50 * 0.003, .gyro_radps_rthz = 12 * 2e-4}};

/// By how much the covariance of a fix grows with its innovation.
inline double scale_of(const Innovation& innovation) {
  return std::max(1.0, innovation.squared_norm / full_weight_below);
}

/// Student's t with six degrees of freedom over three dimensions, up to a constant.
inline double log_likelihood(const Innovation& innovation) {
  return -4.5 * std::log1p(innovation.squared_norm / 6.0) - 0.5 * innovation.log_determinant;
}

constexpr double square(double x) {
  return x * x;
}

constexpr double radians(double degrees) {
  return degrees * geometry::radians_per_degree;
}

template <class Visit>
void Belief::for_each_filter(const Visit& visit) {
  for (int i = 0; i < candidate_count; ++i) {
    const int model = phase == Phase::tracking ? i : 0;
    visit(candidates[static_cast<std::size_t>(i)].filter, models[static_cast<std::size_t>(model)]);
  }
  const auto& best_model = models[static_cast<std::size_t>(phase == Phase::tracking ? best : 0)];
  if (rival.alive) visit(rival.filter, best_model);
  if (former.alive) visit(former.filter, models[static_cast<std::size_t>(former.model)]);
}

}  // namespace sonopose::estimation::kalman
