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
inline constexpr double explained_below = 16.0;         // χ²: 0.1 % are above
inline constexpr TimeNs heading_kept_ns = 500'000'000;  // for a start
inline constexpr double former_s = 8.0;                 // for which a track that was given up is kept
inline constexpr TimeNs doubt_ns = 3'000'000'000;  // an IMU that was wrong a moment ago may be wrong again
inline constexpr int few_fixes = 2;                // enough to distinguish a rest from a smooth cruise

inline constexpr std::array<ProcessNoise, model_count> models{
    ProcessNoise{}, ProcessNoise{.gyro_radps_rthz = 12 * 2e-4, .gyro_bias_radps_rts = 1e-3},
    ProcessNoise{.accel_mps2_rthz = 50 * 0.003, .gyro_radps_rthz = 12 * 2e-4},
    ProcessNoise{.accel_mps2_rthz = 50 * 0.003, .gyro_radps_rthz = 0.2, .gyro_bias_radps_rts = 0.2},
    ProcessNoise{.accel_mps2_rthz = 1.5, .gyro_radps_rthz = 12 * 2e-4, .accel_bias_mps2_rts = 2.0}};

/// Noise of a filter whose yaw is wrong, so that it cannot use the accelerometer.
inline constexpr ProcessNoise fixes_alone{.accel_mps2_rthz = 3.0, .gyro_radps_rthz = 12 * 2e-4};

/// By how much the covariance of a fix grows with its innovation.
inline double scale_of(const Innovation& innovation) {
  return std::max(1.0, innovation.squared_norm / full_weight_below);
}

/// Student's t with six degrees of freedom over three dimensions, up to a constant.
inline double log_likelihood(const Innovation& innovation) {
  return -4.5 * std::log1p(innovation.squared_norm / 6.0) - 0.5 * innovation.log_determinant;
}

inline constexpr double wrong_fix = -4.5;  // log-likelihood of one that lies anywhere within metres

/// Log-likelihood of a fix that may also be wrong, and then lie anywhere within metres.
inline double log_likelihood_or_wrong(const Innovation& innovation) {
  return std::max(log_likelihood(innovation), wrong_fix);
}

constexpr double square(double x) {
  return x * x;
}

constexpr double radians(double degrees) {
  return degrees * geometry::radians_per_degree;
}

inline double squared_norm(const Filter::HeadingInnovation& innovation) {
  return square(innovation.value_rad) / innovation.variance_rad2;
}

/// Student's t with six degrees of freedom, up to a constant.
inline double log_likelihood(const Filter::HeadingInnovation& innovation) {
  return -3.5 * std::log1p(squared_norm(innovation) / 6.0) - 0.5 * std::log(innovation.variance_rad2);
}

template <class Visit>
void Belief::for_each_filter(const Visit& visit) {
  const auto model_of = [this](int i) -> const ProcessNoise& {
    if (phase == Phase::tracking) return models[static_cast<std::size_t>(i)];
    return i == start_count_now() ? fixes_alone : models.front();
  };
  for (int i = 0; i < candidate_count; ++i)
    visit(candidates[static_cast<std::size_t>(i)].filter, model_of(i));
  const ProcessNoise& best_model = model_of(best);
  if (rival.alive) visit(rival.filter, best_model);
  if (former.alive) visit(former.filter, models[static_cast<std::size_t>(former.model)]);
}

}  // namespace sonopose::estimation::kalman
