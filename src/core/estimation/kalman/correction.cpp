// Corrections of a filter by fixes, headings and direct measurements.

#include "estimation/kalman/filter_internal.hpp"
#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::estimation::kalman {
namespace {

using Scalar = Eigen::Matrix<double, 1, 1>;

/// Columns times L⁻ᵀ.
StateColumns whitened(const StateColumns& columns, const Eigen::LLT<Matrix3d>& factor) {
  const Matrix3d inverse = factor.matrixL().solve(Matrix3d::Identity());
  return columns.lazyProduct(inverse.transpose());
}

}  // namespace

/// Columns P Hᵀ of a fix.
StateColumns Filter::fix_columns(double ahead_s) const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  const Matrix3d by_attitude = rotation * geometry::cross_matrix(lever_arm_body_m);
  return covariance.middleCols<3>(at_position) + ahead_s * covariance.middleCols<3>(at_velocity) +
         covariance.middleCols<3>(at_attitude) * by_attitude.transpose() -
         covariance.middleCols<3>(at_lever_arm) * rotation.transpose();
}

FixJacobian Filter::fix_jacobian(double ahead_s, const Vector3d& point_body_m) const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  FixJacobian jacobian = FixJacobian::Zero();
  jacobian.middleCols<3>(at_position).setIdentity();
  jacobian.middleCols<3>(at_velocity) = ahead_s * Matrix3d::Identity();
  jacobian.middleCols<3>(at_attitude) = rotation * geometry::cross_matrix(lever_arm_body_m - point_body_m);
  jacobian.middleCols<3>(at_lever_arm) = -rotation;
  return jacobian;
}

/// Product of H of a fix with columns of the state.
template <int count>
Eigen::Matrix<double, 3, count> Filter::times_columns(const Eigen::Matrix<double, state_size, count>& columns,
                                                      double ahead_s) const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  const Matrix3d by_attitude = rotation * geometry::cross_matrix(lever_arm_body_m);
  return columns.template middleRows<3>(at_position) + ahead_s * columns.template middleRows<3>(at_velocity) +
         by_attitude * columns.template middleRows<3>(at_attitude) -
         rotation * columns.template middleRows<3>(at_lever_arm);
}

/// Covariance H P Hᵀ of a fix.
Matrix3d Filter::fix_covariance_of(const StateColumns& columns, double ahead_s) const {
  const Matrix3d whole = times_columns(columns, ahead_s);
  return 0.5 * (whole + whole.transpose());
}

/// H of a fix for the delay: minus the velocity of the tracked point.
Vector3d Filter::fix_delay_column(const Quaterniond& q_then, double ahead_s) const {
  return q_then * angular_velocity_body_radps.cross(lever_arm_body_m) - velocity_world_mps -
         ahead_s * acceleration_world_mps2;
}

Innovation Filter::fix_innovation(const Vector3d& fix_world_m, const Matrix3d& fix_covariance_m2,
                                  double ahead_s, const Vector3d& point_body_m) const {
  if (!point_body_m.isZero(0.0)) {
    Filter at_point = *this;
    at_point.lever_arm_body_m -= point_body_m;
    return at_point.fix_innovation(fix_world_m, fix_covariance_m2, ahead_s);
  }
  Innovation innovation;
  ahead_s -= delay_error_s;
  const Quaterniond q_then =
      q_body_to_world * geometry::rotation_by((ahead_s * angular_velocity_body_radps).eval());
  const Vector3d predicted = position_world_m + ahead_s * velocity_world_mps +
                             0.5 * ahead_s * ahead_s * acceleration_world_mps2 - q_then * lever_arm_body_m;
  innovation.value_world_m = fix_world_m - predicted;
  innovation.columns = fix_columns(ahead_s);
  if (estimates_delay()) {
    const Vector3d h = fix_delay_column(q_then, ahead_s);
    innovation.delay_row = times_columns(delay_covariance, ahead_s) + delay_variance_s2 * h;
    innovation.columns += delay_covariance * h.transpose();
    const Matrix3d by_delay = h * innovation.delay_row.transpose();
    innovation.covariance_m2 = 0.5 * (by_delay + by_delay.transpose());
  } else {
    innovation.covariance_m2.setZero();
  }
  if (scale) {
    innovation.scale_row = times_columns(scale->covariance, ahead_s);
    if (estimates_delay())
      innovation.scale_row += scale->delay_covariance_s * fix_delay_column(q_then, ahead_s);
  }
  innovation.covariance_m2 += fix_covariance_of(innovation.columns, ahead_s) + fix_covariance_m2;
  const Eigen::LLT<Matrix3d> factor(innovation.covariance_m2);
  if (factor.info() != Eigen::Success) {
    innovation.squared_norm = std::numeric_limits<double>::infinity();  // rejected by this
    return innovation;
  }
  innovation.squared_norm = factor.matrixL().solve(innovation.value_world_m).squaredNorm();
  innovation.log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return innovation;
}

void Filter::correct_fix(const Innovation& innovation, const Matrix3d& more_covariance_m2) {
  const Eigen::LLT<Matrix3d> factor(innovation.covariance_m2 + more_covariance_m2);
  if (factor.info() != Eigen::Success) return;
  // W = P Hᵀ L⁻ᵀ with S = L Lᵀ: the gain times the innovation is W L⁻¹ ν, and P ← P − W Wᵀ.
  const StateColumns w = whitened(innovation.columns, factor);
  const Vector3d whitened_innovation = factor.matrixL().solve(innovation.value_world_m);
  const Vector3d w_delay = factor.matrixL().solve(innovation.delay_row);
  correct(w, whitened_innovation, w_delay,
          scale ? factor.matrixL().solve(innovation.scale_row).eval() : w_delay);
}

/// Jacobian H of a heading with respect to the attitude error. The direction of a body axis b = R a in the
/// horizontal plane turns by φ_z − b_z (b_x φ_x + b_y φ_y) / (b_x² + b_y²) for a small rotation φ = R δθ of
/// the world.
Filter::HeadingRow Filter::heading_row(const Vector3d& axis_world) const {
  const double horizontal = axis_world.head<2>().squaredNorm();
  const Vector3d by_world(-axis_world.z() * axis_world.x() / horizontal,
                          -axis_world.z() * axis_world.y() / horizontal, 1.0);
  return by_world.transpose() * q_body_to_world.toRotationMatrix();
}

/// Direction of the pair's axis at a stamp `ahead_s` after the latest step.
Vector3d Filter::axis_world(double mount_rad, double ahead_s) const {
  const Quaterniond q_then =
      q_body_to_world *
      geometry::rotation_by(((ahead_s - delay_error_s) * angular_velocity_body_radps).eval());
  return q_then * Vector3d(std::cos(mount_rad), std::sin(mount_rad), 0.0);
}

Filter::HeadingInnovation Filter::heading_innovation(double heading_world_rad, double mount_rad,
                                                     double variance_rad2, double ahead_s) const {
  constexpr double min_horizontal = 0.1;
  const Vector3d axis = axis_world(mount_rad, ahead_s);
  HeadingInnovation innovation;
  innovation.observable = axis.head<2>().norm() > min_horizontal;
  if (!innovation.observable) return innovation;
  innovation.value_rad = geometry::wrap_angle(heading_world_rad - std::atan2(axis.y(), axis.x()));
  const HeadingRow row = heading_row(axis);
  const double h = -row.dot(angular_velocity_body_radps);  // H of the delay
  innovation.row = row;
  innovation.column = covariance.middleCols<3>(at_attitude) * row.transpose();
  if (estimates_delay()) {
    innovation.column += h * delay_covariance;
    innovation.delay_row = row.dot(delay_covariance.segment<3>(at_attitude)) + h * delay_variance_s2;
  }
  if (scale) {
    innovation.scale_row = row.dot(scale->covariance.segment<3>(at_attitude));
    if (estimates_delay()) innovation.scale_row += h * scale->delay_covariance_s;
  }
  innovation.variance_rad2 =
      row.dot(innovation.column.segment<3>(at_attitude)) + h * innovation.delay_row + variance_rad2;
  return innovation;
}

void Filter::correct_heading(double heading_world_rad, double mount_rad, double variance_rad2,
                             double ahead_s) {
  const HeadingInnovation innovation =
      heading_innovation(heading_world_rad, mount_rad, variance_rad2, ahead_s);
  if (!innovation.observable) return;
  const double std_rad = std::sqrt(innovation.variance_rad2);
  correct<1>(innovation.column / std_rad, Scalar(innovation.value_rad / std_rad),
             Scalar(innovation.delay_row / std_rad), Scalar(innovation.scale_row / std_rad));
}

void Filter::update_direct(StateIndex index, const Vector3d& innovation, double variance) {
  const StateColumns columns = covariance.middleCols<3>(index);
  const Matrix3d s = columns.middleRows<3>(index) + variance * Matrix3d::Identity();
  const Eigen::LLT<Matrix3d> factor(s);
  if (factor.info() != Eigen::Success) return;
  const StateColumns w = whitened(columns, factor);
  const Vector3d whitened_innovation = factor.matrixL().solve(innovation);
  const Vector3d w_delay = factor.matrixL().solve(delay_covariance.segment<3>(index));
  correct(w, whitened_innovation, w_delay,
          scale ? factor.matrixL().solve(scale->covariance.segment<3>(index)).eval() : w_delay);
}

void Filter::add_variance(StateIndex index, const Vector3d& variance) {
  covariance.diagonal().segment<3>(index) += variance;
}

void Filter::add_uncertain_motion(const Vector3d& impulse_body_mps, const Vector3d& turn_body_rad) {
  const Vector3d impulse_world_mps = q_body_to_world * impulse_body_mps;
  covariance.block<3, 3>(at_velocity, at_velocity) += impulse_world_mps * impulse_world_mps.transpose();
  covariance.block<3, 3>(at_attitude, at_attitude) += turn_body_rad * turn_body_rad.transpose();
}

void Filter::decorrelate(StateIndex index, const Vector3d& variance) {
  covariance.middleRows<3>(index).setZero();
  covariance.middleCols<3>(index).setZero();
  covariance.diagonal().segment<3>(index) = variance;
  delay_covariance.segment<3>(index).setZero();
  if (scale) scale->covariance.segment<3>(index).setZero();
}

void Filter::turn_world(double angle_rad) {
  const Quaterniond q_turn = geometry::rotation_about_z(angle_rad);
  const Matrix3d turn = q_turn.toRotationMatrix();
  position_world_m = turn * position_world_m;
  velocity_world_mps = turn * velocity_world_mps;
  acceleration_world_mps2 = turn * acceleration_world_mps2;
  q_body_to_world = (q_turn * q_body_to_world).normalized();
  for (const StateIndex index : {at_position, at_velocity}) {
    covariance.middleRows<3>(index) = (turn * covariance.middleRows<3>(index)).eval();
    covariance.middleCols<3>(index) = (covariance.middleCols<3>(index) * turn.transpose()).eval();
    delay_covariance.segment<3>(index) = (turn * delay_covariance.segment<3>(index)).eval();
    if (scale) scale->covariance.segment<3>(index) = (turn * scale->covariance.segment<3>(index)).eval();
  }
  mirror_upper(covariance);
}

void Filter::estimate_delay(double variance_s2) {
  delay_covariance.setZero();
  delay_variance_s2 = variance_s2;
  if (variance_s2 == 0.0) delay_error_s = 0.0;
  if (scale) scale->delay_covariance_s = 0.0;
}

void Filter::add_yaw_variance(double variance_rad2) {
  const Vector3d up_body = geometry::up_in_body(q_body_to_world);
  const Matrix3d about_up = up_body * up_body.transpose();  // first, so that the sum stays symmetric
  covariance.block<3, 3>(at_attitude, at_attitude) += variance_rad2 * about_up;
}

/// Applies P ← P − W Wᵀ and injects the error W e, where e is the innovation times L⁻¹. `w_delay` is the row
/// of W for the delay, `w_scale` that for the scale of measured velocities, if there is one.
template <int rows>
void Filter::correct(const Eigen::Matrix<double, state_size, rows>& w,
                     const Eigen::Matrix<double, rows, 1>& innovation,
                     const Eigen::Matrix<double, rows, 1>& w_delay,
                     const Eigen::Matrix<double, rows, 1>& w_scale) {
  constexpr double max_delay_error_s = 0.3;
  constexpr double min_delay_std_s = 1e-5;
  const StateVector error = w * innovation;
  covariance -= w.lazyProduct(w.transpose());
  inject(error);
  if (scale) {
    constexpr double min_scale_std = 1e-4;
    scale->covariance -= w * w_scale;
    if (estimates_delay()) scale->delay_covariance_s -= w_delay.dot(w_scale);
    scale->variance = std::max(scale->variance - w_scale.squaredNorm(), min_scale_std * min_scale_std);
    scale->error = std::clamp(scale->error + w_scale.dot(innovation), -max_scale_error, max_scale_error);
  }
  if (!estimates_delay()) return;
  delay_covariance -= w * w_delay;
  delay_variance_s2 = std::max(delay_variance_s2 - w_delay.squaredNorm(), min_delay_std_s * min_delay_std_s);
  delay_error_s = std::clamp(delay_error_s + w_delay.dot(innovation), -max_delay_error_s, max_delay_error_s);
}

void Filter::inject(const StateVector& error) {
  position_world_m += error.segment<3>(at_position);
  velocity_world_mps += error.segment<3>(at_velocity);
  q_body_to_world =
      (q_body_to_world * geometry::rotation_by(error.segment<3>(at_attitude).eval())).normalized();
  gyro_bias_body_radps += error.segment<3>(at_gyro_bias);
  accel_bias_body_mps2 += error.segment<3>(at_accel_bias);
  lever_arm_body_m += error.segment<3>(at_lever_arm);
}

bool Filter::is_finite() const {
  return position_world_m.allFinite() && velocity_world_mps.allFinite() &&
         q_body_to_world.coeffs().allFinite() && covariance.diagonal().allFinite();
}

}  // namespace sonopose::estimation::kalman
