#pragma once
/// \file
/// Likelihood of the fixes and headings of a drive for given mount, delay and noise, by one forward pass of
/// the error-state Kalman filter. Private to this folder.

#include <sonopose/estimation/kalman/state.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonopose::calibration::drive::detail {

using estimation::kalman::ImuMeasurement;

/// Parameters of the sensors for one pass.
struct Parameters {
  double mount_rad = 0;            ///< from body X to the axis of the pair
  double start_yaw_rad = 0;        ///< yaw at the first sample of a log without headings
  double delay_s = 0;              ///< age of fixes and headings beyond their stamps
  double fix_horizontal_m = 0.03;  ///< standard deviation per axis
  double fix_vertical_m = 0.03;
  double heading_rad = 0.05;
  double accel_mps2_rthz = 0.003;  ///< spectral density of the accelerometer's noise
  double gyro_radps_rthz = 2e-4;
};

struct Fix {
  TimeNs time_ns = 0;  ///< stamp: the emission
  Vector3d position_world_m = Vector3d::Zero();
  std::uint64_t sequence = 0;  ///< event number
  bool used = true;
};

struct Heading {
  TimeNs time_ns = 0;  ///< stamp: the emission
  double heading_world_rad = 0;
  std::uint64_t sequence = 0;  ///< event number
  bool used = true;
};

/// Measurements of one log, or of a piece of it, in the order of their stamps.
struct Measurements {
  std::vector<ImuMeasurement> imu;  ///< calibrated
  std::vector<Fix> fixes;
  std::vector<Heading> headings;
  std::size_t recording = 0;  ///< index of the recording

  [[nodiscard]] bool has_heading() const;
};

/// A fix minus its prediction, or in the first component a heading.
struct Residual {
  Vector3d value = Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  bool is_heading = false;
  std::size_t index = 0;     ///< index among the fixes or headings
  double squared_norm = 0;   ///< squared norm, normalised by the covariance
  double minus_2_log_l = 0;  ///< log det S + νᵀ S⁻¹ ν
};

/// Lever arm from the tracked point to the IMU in body axes, as estimated at the end of a pass.
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
  /// Squared norm above which a measurement counts with a larger noise, so that a filter with wrong
  /// parameters is never lost; 0: all count fully.
  double soft_gate = 0;
  Vector3d lever_arm_m = Vector3d::Zero();  ///< start of the lever arm's estimate
};

/// Distance of the measurements of a piece to its ends, as the delay may move them.
inline constexpr double margin_s = 0.4;

/// Residuals of all used fixes and headings except those of the first seconds, in which the filter settles.
/// The IMU must not be silent, and the measurements must keep `margin_s`.
Pass forward_pass(const Measurements& piece, const Parameters& parameters, const PassOptions& options);

}  // namespace sonopose::calibration::drive::detail
