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

/// Returns one state per sample. `signs`: factors of the axes of the specific force, ±1. Biases are in body
/// axes.
std::vector<IntegralState> integral_of(std::span<const Reading> imu, const Vector3d& signs,
                                       const Vector3d& gyro_bias_radps, const Vector3d& accel_bias_mps2);

/// State at a time, from the sample before it; outside of the segment, from the nearest sample.
IntegralState state_at(const std::vector<IntegralState>& states, double since_start_s);

}  // namespace sonopose::motion::fit::detail
