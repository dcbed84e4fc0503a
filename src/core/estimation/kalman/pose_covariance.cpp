// Covariances of a filter's outputs.

#include "estimation/kalman/filter_internal.hpp"
#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/geometry/rotation.hpp>

namespace sonopose::estimation::kalman {

Covariance<6> Filter::pose_covariance() const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  // The covariance may be older than the state; the velocity's share has grown since.
  const double since_s = pending.position_velocity_s;
  const StateColumns position = fix_columns(since_s);
  Covariance<6>::Matrix result;
  result.block<3, 3>(0, 0) = fix_covariance_of(position, since_s);
  result.block<3, 3>(0, 3) = (rotation * position.middleRows<3>(at_attitude)).transpose();
  result.block<3, 3>(3, 3) =
      rotation * covariance.block<3, 3>(at_attitude, at_attitude) * rotation.transpose();
  return Covariance<6>::from_matrix(result);
}

Covariance<3> Filter::velocity_covariance() const {
  // The covariance of v − R (ω × l).
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  const Matrix3d by_attitude =
      rotation * geometry::cross_matrix(angular_velocity_body_radps.cross(lever_arm_body_m));
  const Matrix3d by_gyro_bias = -rotation * geometry::cross_matrix(lever_arm_body_m);
  const Matrix3d by_lever_arm = -rotation * geometry::cross_matrix(angular_velocity_body_radps);
  const StateColumns columns = covariance.middleCols<3>(at_velocity) +
                               covariance.middleCols<3>(at_attitude).lazyProduct(by_attitude.transpose()) +
                               covariance.middleCols<3>(at_gyro_bias).lazyProduct(by_gyro_bias.transpose()) +
                               covariance.middleCols<3>(at_lever_arm).lazyProduct(by_lever_arm.transpose());
  const Matrix3d whole =
      columns.middleRows<3>(at_velocity) + by_attitude * columns.middleRows<3>(at_attitude) +
      by_gyro_bias * columns.middleRows<3>(at_gyro_bias) + by_lever_arm * columns.middleRows<3>(at_lever_arm);
  return Covariance<3>::from_matrix(0.5 * (whole + whole.transpose()));
}

double Filter::yaw_variance_rad2() const {
  const Vector3d up_body = geometry::up_in_body(q_body_to_world);
  return up_body.dot(covariance.block<3, 3>(at_attitude, at_attitude) * up_body);
}

}  // namespace sonopose::estimation::kalman
