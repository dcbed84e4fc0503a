// Correction of a filter by a velocity along one body axis.

#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

/// Velocity in body axes, without the components that may as well be errors. What turns the measurement with
/// the attitude would otherwise seem to show the attitude, ever again.
Vector3d significant(const Vector3d& velocity_body_mps, const Matrix3d& to_body,
                     const Matrix3d& covariance_m2ps2) {
  constexpr double min_sigmas = 3.0;
  const Matrix3d in_body = to_body * covariance_m2ps2 * to_body.transpose();
  const auto is_significant =
      velocity_body_mps.array().square() > min_sigmas * min_sigmas * in_body.diagonal().array();
  return is_significant.select(velocity_body_mps, 0.0);
}

}  // namespace

VelocityInnovation Filter::velocity_innovation(int axis, double velocity_mps, double variance_m2ps2,
                                               const Vector3d& from_tracked_body_m, bool is_scaled,
                                               double ahead_s) const {
  const Vector3d place_body_m = from_tracked_body_m - lever_arm_body_m;  // from the IMU
  const Quaterniond q_then =
      q_body_to_world * geometry::rotation_by((ahead_s * angular_velocity_body_radps).eval());
  const Vector3d imu_body_mps =
      q_then.conjugate() * (velocity_world_mps + ahead_s * acceleration_world_mps2).eval();
  const double factor = is_scaled && scale ? 1.0 + scale->error : 1.0;
  VelocityInnovation innovation;
  innovation.estimated_mps = (imu_body_mps + angular_velocity_body_radps.cross(place_body_m))[axis];
  innovation.value_mps = velocity_mps - factor * innovation.estimated_mps;
  // H, which is that of the latest step: the turn since then is small.
  StateVector h = StateVector::Zero();
  const Matrix3d to_body = q_then.toRotationMatrix().transpose();
  const Vector3d turning_mps =
      significant(imu_body_mps, to_body, covariance.block<3, 3>(at_velocity, at_velocity));
  h.segment<3>(at_velocity) = factor * to_body.row(axis).transpose();
  h.segment<3>(at_attitude) = factor * geometry::cross_matrix(turning_mps).row(axis).transpose();
  h.segment<3>(at_gyro_bias) = factor * geometry::cross_matrix(place_body_m).row(axis).transpose();
  h.segment<3>(at_lever_arm) =
      -factor * geometry::cross_matrix(angular_velocity_body_radps).row(axis).transpose();
  innovation.column.noalias() = covariance * h;
  if (estimates_delay()) innovation.delay_row = h.dot(delay_covariance);
  if (scale) innovation.scale_row = h.dot(scale->covariance);
  if (scale && is_scaled) {
    const double by_scale_mps = innovation.estimated_mps;
    innovation.column += by_scale_mps * scale->covariance;
    innovation.scale_row += by_scale_mps * scale->variance;
    if (estimates_delay()) innovation.delay_row += by_scale_mps * scale->delay_covariance_s;
  }
  innovation.variance_m2ps2 = h.dot(innovation.column) + variance_m2ps2;
  if (scale && is_scaled) innovation.variance_m2ps2 += innovation.estimated_mps * innovation.scale_row;
  return innovation;
}

void Filter::correct_velocity(const VelocityInnovation& innovation, double more_variance_m2ps2) {
  using Vector1 = Eigen::Matrix<double, 1, 1>;
  const double std_mps = std::sqrt(innovation.variance_m2ps2 + more_variance_m2ps2);
  correct<1>(innovation.column / std_mps, Vector1(innovation.value_mps / std_mps),
             Vector1(innovation.delay_row / std_mps), Vector1(innovation.scale_row / std_mps));
}

}  // namespace sonopose::estimation::kalman
