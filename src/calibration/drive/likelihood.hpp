#pragma once
/// \file
/// How probable the fixes and headings of a drive are, for given mount, delay and noise: one forward pass of
/// the error-state Kalman filter. Private to this folder.

#include <sonopose/estimation/kalman/state.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonopose::calibration::drive::detail {

using estimation::kalman::ImuMeasurement;

/// What one pass needs to know of the sensors.
struct Parameters {
  double mount_rad = 0;            ///< from body X to the axis of the pair
  double start_yaw_rad = 0;        ///< without headings: the yaw at the first sample
  double delay_s = 0;              ///< by which fixes and headings are older than their stamps
  double fix_horizontal_m = 0.03;  ///< standard deviation per axis
  double fix_vertical_m = 0.03;
  double heading_rad = 0.05;
  double accel_mps2_rthz = 0.003;  ///< spectral density of the accelerometer's noise
  double gyro_radps_rthz = 2e-4;
};

struct Fix {
  TimeNs time_ns = 0;  ///< its stamp: the emission
  Vector3d position_world_m = Vector3d::Zero();
  std::uint64_t sequence = 0;  ///< of its event
  bool used = true;
};

struct Heading {
  TimeNs time_ns = 0;  ///< its stamp: the emission
  double heading_world_rad = 0;
  std::uint64_t sequence = 0;  ///< of its event
  bool used = true;
};

/// The measurements of one log in the order of their stamps.
struct Measurements {
  std::vector<ImuMeasurement> imu;  ///< calibrated
  std::vector<Fix> fixes;
  std::vector<Heading> headings;

  [[nodiscard]] bool has_heading() const;
};

/// A fix minus its prediction, or in the first component a heading.
struct Residual {
  Vector3d value = Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  bool is_heading = false;
  std::size_t index = 0;     ///< among the fixes or headings
  double squared_norm = 0;   ///< normalised by the covariance
  double minus_2_log_l = 0;  ///< log det S + νᵀ S⁻¹ ν
};

/// The lever arm from the tracked point to the IMU in body axes, as the filter knows it at the end of a pass.
struct LeverArm {
  Vector3d value_m = Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

struct Pass {
  std::vector<Residual> residuals;
  LeverArm lever_arm;
  double minus_2_log_l = 0;
};

struct PassOptions {
  /// Above this squared norm a measurement counts with a larger noise, so that a filter with wrong parameters
  /// is never lost; 0: all count fully.
  double soft_gate = 0;
  Vector3d lever_arm_m = Vector3d::Zero();  ///< where the estimate of the lever arm starts
};

/// The residuals of all used fixes and headings but those of the first seconds, which find the start.
Pass forward_pass(const Measurements& log, const Parameters& parameters, const PassOptions& options);

}  // namespace sonopose::calibration::drive::detail
