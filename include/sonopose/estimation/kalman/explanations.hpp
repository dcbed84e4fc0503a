#pragma once
/// \file
/// Statistics of the innovations that tell a wrong IMU from wrong or noisy fixes.

#include <sonopose/estimation/kalman/filter.hpp>

namespace sonopose::estimation::kalman {

/// The correlation of an innovation with the one before. It is zero if the gain is right; errors of the
/// motion make it positive, whatever their size (Mehra, On the Identification of Variances and Adaptive
/// Kalman Filtering, 1970).
struct Correlation {
  Vector3d last = Vector3d::Zero();  ///< normalised innovation
  double product = 0;                ///< mean of the products
  double square = 1;                 ///< mean of the squares

  void add(const Innovation& innovation);
  /// The share of the squares that is white.
  [[nodiscard]] double white_share() const;
  bool operator==(const Correlation&) const = default;
};

/// Log-likelihoods of the recent fixes under three explanations, with forgetting.
struct Explanations {
  double best = 0;                         ///< the track and motion of the best filter, or wrong fixes
  double rival = 0;                        ///< another track, and a correct IMU
  double gyro = 0;                         ///< a wrong gyroscope
  double accel = 0;                        ///< a wrong accelerometer
  Vector3d scatter_m2 = Vector3d::Zero();  ///< mean square of the best filter's innovations; zero: none yet
  TimeNs shift_ns = 0;                     ///< latest fix
  Vector3d shift_world_m = Vector3d::Zero();    ///< offset of the other track from the best filter
  Vector3d shift_world_mps = Vector3d::Zero();  ///< its growth
  double shift_variance_m2 = 0;                 ///< per axis; 0: none yet
  double shift_covariance = 0;
  double shift_rate_variance = 0;

  void add_heading(const Filter::HeadingInnovation& of_best, const Filter::HeadingInnovation& of_gyro);
  double of_noise(const Innovation& of_best_innovation);
  double of_shift(TimeNs time_ns, const Vector3d& offset_world_m, const Matrix3d& covariance);

  bool operator==(const Explanations&) const = default;
};

}  // namespace sonopose::estimation::kalman
