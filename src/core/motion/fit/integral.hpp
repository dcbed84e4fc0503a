#pragma once
/// \file
/// The integral of the IMU over a segment, relative to the body at its start. Private to this folder.

#include "motion/window.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace sonopose::motion::fit::detail {

/// Integral from the start of the segment to one of its samples, in the body axes of the start, without
/// gravity.
struct IntegralState {
  double since_start_s = 0;
  Eigen::Quaterniond q_body_to_start = Eigen::Quaterniond::Identity();
  Vector3d velocity_mps = Vector3d::Zero();  ///< integral of the specific force
  Vector3d position_m = Vector3d::Zero();    ///< integral of the velocity
  Vector3d rate_body_radps = Vector3d::Zero();
  Vector3d force_body_mps2 = Vector3d::Zero();
  // Derivatives with respect to the biases of gyroscope and accelerometer.
  Eigen::Matrix3d attitude_by_gyro = Eigen::Matrix3d::Zero();  ///< derivative of a rotation about body axes
  Eigen::Matrix3d velocity_by_gyro = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_accel = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d position_by_gyro = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d position_by_accel = Eigen::Matrix3d::Zero();
};

/// Integral of the samples of a segment. It is linear in small changes of the biases, and made again for
/// larger ones.
class Integral {
public:
  /// `signs`: factors of the axes of the specific force, ±1. `imu`, at least one sample, must outlive it.
  Integral(std::span<const Reading> imu, Vector3d signs);

  /// Sets the biases, in body axes.
  void set_biases(const Vector3d& gyro_bias_radps, const Vector3d& accel_bias_mps2);

  /// State at a time, from the sample before it; outside of the segment, from the nearest sample.
  [[nodiscard]] IntegralState at(double since_start_s) const;

  [[nodiscard]] IntegralState at_end() const { return at(states_.back().since_start_s); }

private:
  void integrate();

  std::span<const Reading> imu_;
  Vector3d signs_;
  Vector3d gyro_bias_radps_ = Vector3d::Zero();  ///< with which the states were integrated
  Vector3d accel_bias_mps2_ = Vector3d::Zero();
  Vector3d gyro_bias_change_radps_ = Vector3d::Zero();  ///< since then
  Vector3d accel_bias_change_mps2_ = Vector3d::Zero();
  std::vector<IntegralState> states_;  ///< one per sample
};

}  // namespace sonopose::motion::fit::detail
