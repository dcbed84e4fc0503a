#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::estimation::kalman {
namespace {

using Scalar = Eigen::Matrix<double, 1, 1>;

const Vector3d gravity_world_mps2{0.0, 0.0, -standard_gravity_mps2};

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// The columns times L⁻ᵀ.
StateColumns whitened(const StateColumns& columns, const Eigen::LLT<Matrix3d>& factor) {
  const Matrix3d inverse = factor.matrixL().solve(Matrix3d::Identity());
  return columns.lazyProduct(inverse.transpose());
}

/// Copies the upper triangle to the lower one.
void mirror_upper(StateCovariance& covariance) {
  for (int column = 0; column < state_size; ++column) {
    for (int row = column + 1; row < state_size; ++row) covariance(row, column) = covariance(column, row);
  }
}

}  // namespace

NominalStep Filter::step(const Vector3d& rate_body_radps, const Vector3d& specific_force_body_mps2,
                         double dt_s) const {
  NominalStep step;
  NominalState& after = step.after;
  after.angular_velocity_body_radps = rate_body_radps - gyro_bias_body_radps;
  const Quaterniond half = geometry::rotation_by((0.5 * dt_s * after.angular_velocity_body_radps).eval());
  const Quaterniond q_middle = q_body_to_world * half;
  step.rotation_middle = q_middle.toRotationMatrix();
  step.force_world_mps2 = step.rotation_middle * (specific_force_body_mps2 - accel_bias_body_mps2);
  after.acceleration_world_mps2 = step.force_world_mps2 + gravity_world_mps2;
  after.position_world_m =
      position_world_m + dt_s * velocity_world_mps + 0.5 * dt_s * dt_s * after.acceleration_world_mps2;
  after.velocity_world_mps = velocity_world_mps + dt_s * after.acceleration_world_mps2;
  after.q_body_to_world = (q_middle * half).normalized();
  return step;
}

void Filter::predict(const Vector3d& rate_body_radps, const Vector3d& specific_force_body_mps2, double dt_s) {
  const NominalStep step = this->step(rate_body_radps, specific_force_body_mps2, dt_s);
  // In the world frame an attitude error stays as it is but for the gyro bias.
  begin_transition();
  Transition& f = pending;
  f.duration_s += dt_s;
  f.position_velocity_s += dt_s;
  f.impulse_sum_m += dt_s * f.impulse_mps;
  f.rotation_double_sum_s2 += dt_s * f.rotation_sum_s;
  f.position_gyro_bias += dt_s * f.velocity_gyro_bias;
  for (int i = 0; i < 3; ++i) {
    f.velocity_gyro_bias.col(i) += dt_s * step.force_world_mps2.cross(f.rotation_sum_s.col(i));
  }
  f.impulse_mps += dt_s * step.force_world_mps2;
  f.rotation_sum_s += dt_s * step.rotation_middle;
  position_world_m = step.after.position_world_m;
  velocity_world_mps = step.after.velocity_world_mps;
  q_body_to_world = step.after.q_body_to_world;
  acceleration_world_mps2 = step.after.acceleration_world_mps2;
  angular_velocity_body_radps = step.after.angular_velocity_body_radps;
}

void Filter::begin_transition() {
  if (pending.duration_s == 0.0) pending.rotation_start = q_body_to_world.toRotationMatrix();
}

void Filter::coast(double duration_s, const UnknownMotion& motion) {
  const double tau_s = motion.slowing_s;
  const double left = std::exp(-duration_s / tau_s);
  const double moving_s = tau_s * (1.0 - left);
  position_world_m += moving_s * velocity_world_mps;
  velocity_world_mps *= left;
  acceleration_world_mps2.setZero();
  angular_velocity_body_radps.setZero();

  StateCovariance& P = covariance;  // NOLINT(readability-identifier-naming): the symbol of the equations
  P.middleRows<3>(at_position) += moving_s * P.middleRows<3>(at_velocity);
  P.middleRows<3>(at_velocity) *= left;
  P.middleCols<3>(at_position) += moving_s * P.middleCols<3>(at_velocity);
  P.middleCols<3>(at_velocity) *= left;
  delay_covariance.segment<3>(at_position) += moving_s * delay_covariance.segment<3>(at_velocity);
  delay_covariance.segment<3>(at_velocity) *= left;
  // The integrals of white acceleration whose velocity falls.
  const double accel = motion.accel_mps2_rthz * motion.accel_mps2_rthz;
  P.diagonal().segment<3>(at_position).array() +=
      accel * tau_s * tau_s * (duration_s - 2.0 * moving_s + 0.5 * tau_s * (1.0 - left * left));
  for (int i = 0; i < 3; ++i) P(at_position + i, at_velocity + i) += 0.5 * accel * moving_s * moving_s;
  P.diagonal().segment<3>(at_velocity).array() += 0.5 * accel * tau_s * (1.0 - left * left);
  P.diagonal().segment<3>(at_attitude).array() += motion.tilt_rad_rts * motion.tilt_rad_rts * duration_s;
  add_yaw_variance(motion.yaw_rad_rts * motion.yaw_rad_rts * duration_s);
  mirror_upper(P);
}

StateCovariance Filter::transition() const {
  const Matrix3d to_body = q_body_to_world.toRotationMatrix().transpose();
  StateCovariance transition = StateCovariance::Identity();
  if (!(pending.duration_s > 0.0)) return transition;
  const auto block = [&transition](StateIndex row, StateIndex column) {
    return transition.block<3, 3>(row, column);
  };
  block(at_position, at_velocity) = pending.position_velocity_s * Matrix3d::Identity();
  block(at_position, at_attitude) = -cross_matrix(pending.impulse_sum_m) * pending.rotation_start;
  block(at_position, at_gyro_bias) = pending.position_gyro_bias;
  block(at_position, at_accel_bias) = -pending.rotation_double_sum_s2;
  block(at_velocity, at_attitude) = -cross_matrix(pending.impulse_mps) * pending.rotation_start;
  block(at_velocity, at_gyro_bias) = pending.velocity_gyro_bias;
  block(at_velocity, at_accel_bias) = -pending.rotation_sum_s;
  block(at_attitude, at_attitude) = to_body * pending.rotation_start;
  block(at_attitude, at_gyro_bias) = -to_body * pending.rotation_sum_s;
  return transition;
}

void Filter::propagate(const ProcessNoise& noise) {
  const double t = pending.position_velocity_s;
  const double duration_s = pending.duration_s;
  if (!(duration_s > 0.0)) return;
  const Matrix3d to_body = q_body_to_world.toRotationMatrix().transpose();
  const Matrix3d attitude_attitude = to_body * pending.rotation_start;
  const Matrix3d attitude_gyro_bias = -to_body * pending.rotation_sum_s;
  const Matrix3d velocity_attitude = -cross_matrix(pending.impulse_mps) * pending.rotation_start;
  const Matrix3d position_attitude = -cross_matrix(pending.impulse_sum_m) * pending.rotation_start;
  const Matrix3d velocity_accel_bias = -pending.rotation_sum_s;
  const Matrix3d position_accel_bias = -pending.rotation_double_sum_s2;
  const Matrix3d& velocity_gyro_bias = pending.velocity_gyro_bias;
  const Matrix3d& position_gyro_bias = pending.position_gyro_bias;
  StateCovariance& P = covariance;  // NOLINT(readability-identifier-naming): the symbol of the equations
  // P Φᵀ by the columns of position, velocity and attitude.
  const auto column = [&P](StateIndex index) { return P.middleCols<3>(index); };
  const auto times = [](const auto& columns, const Matrix3d& block) {
    return columns.lazyProduct(block.transpose());
  };
  const StateColumns position =
      column(at_position) + t * column(at_velocity) + times(column(at_attitude), position_attitude) +
      times(column(at_gyro_bias), position_gyro_bias) + times(column(at_accel_bias), position_accel_bias);
  const StateColumns velocity = column(at_velocity) + times(column(at_attitude), velocity_attitude) +
                                times(column(at_gyro_bias), velocity_gyro_bias) +
                                times(column(at_accel_bias), velocity_accel_bias);
  const StateColumns attitude =
      times(column(at_attitude), attitude_attitude) + times(column(at_gyro_bias), attitude_gyro_bias);

  // Φ (P Φᵀ): the blocks of the upper triangle that change.
  const auto rows = [](const auto& columns, StateIndex index) {
    return columns.template middleRows<3>(index);
  };
  const auto by_position =
      [&]<int count>(
          const Eigen::Matrix<double, state_size, count>& columns) -> Eigen::Matrix<double, 3, count> {
    return rows(columns, at_position) + t * rows(columns, at_velocity) +
           position_attitude.lazyProduct(rows(columns, at_attitude)) +
           position_gyro_bias.lazyProduct(rows(columns, at_gyro_bias)) +
           position_accel_bias.lazyProduct(rows(columns, at_accel_bias));
  };
  const auto by_velocity =
      [&]<int count>(
          const Eigen::Matrix<double, state_size, count>& columns) -> Eigen::Matrix<double, 3, count> {
    return rows(columns, at_velocity) + velocity_attitude.lazyProduct(rows(columns, at_attitude)) +
           velocity_gyro_bias.lazyProduct(rows(columns, at_gyro_bias)) +
           velocity_accel_bias.lazyProduct(rows(columns, at_accel_bias));
  };
  const auto by_attitude =
      [&]<int count>(
          const Eigen::Matrix<double, state_size, count>& columns) -> Eigen::Matrix<double, 3, count> {
    return attitude_attitude.lazyProduct(rows(columns, at_attitude)) +
           attitude_gyro_bias.lazyProduct(rows(columns, at_gyro_bias));
  };
  P.block<3, 3>(at_position, at_position) = by_position(position);
  P.block<3, 3>(at_position, at_velocity) = by_position(velocity);
  P.block<3, 3>(at_position, at_attitude) = by_position(attitude);
  P.block<3, 3>(at_velocity, at_velocity) = by_velocity(velocity);
  P.block<3, 3>(at_velocity, at_attitude) = by_velocity(attitude);
  P.block<3, 3>(at_attitude, at_attitude) = by_attitude(attitude);
  P.block<3, 9>(at_position, at_gyro_bias) = position.bottomRows<9>().transpose();
  P.block<3, 9>(at_velocity, at_gyro_bias) = velocity.bottomRows<9>().transpose();
  P.block<3, 9>(at_attitude, at_gyro_bias) = attitude.bottomRows<9>().transpose();

  const double accel = noise.accel_mps2_rthz * noise.accel_mps2_rthz;
  P.diagonal().segment<3>(at_position).array() += accel * t * t * t / 3.0;
  for (int i = 0; i < 3; ++i) P(at_position + i, at_velocity + i) += 0.5 * accel * t * t;
  P.diagonal().segment<3>(at_velocity).array() += accel * duration_s;
  P.diagonal().segment<3>(at_attitude).array() += noise.gyro_radps_rthz * noise.gyro_radps_rthz * duration_s;
  P.diagonal().segment<3>(at_gyro_bias).array() +=
      noise.gyro_bias_radps_rts * noise.gyro_bias_radps_rts * duration_s;
  P.diagonal().segment<3>(at_accel_bias).array() +=
      noise.accel_bias_mps2_rts * noise.accel_bias_mps2_rts * duration_s;
  mirror_upper(P);
  if (estimates_delay()) {
    const StateVector before = delay_covariance;
    delay_covariance.segment<3>(at_position) = by_position(before);
    delay_covariance.segment<3>(at_velocity) = by_velocity(before);
    delay_covariance.segment<3>(at_attitude) = by_attitude(before);
    delay_variance_s2 += noise.delay_s_rts * noise.delay_s_rts * duration_s;
  }
  pending = Transition{};
}

/// P Hᵀ of a fix.
StateColumns Filter::fix_columns(double ahead_s) const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  const Matrix3d by_attitude = rotation * cross_matrix(lever_arm_body_m);
  return covariance.middleCols<3>(at_position) + ahead_s * covariance.middleCols<3>(at_velocity) +
         covariance.middleCols<3>(at_attitude) * by_attitude.transpose() -
         covariance.middleCols<3>(at_lever_arm) * rotation.transpose();
}

FixJacobian Filter::fix_jacobian(double ahead_s) const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  FixJacobian jacobian = FixJacobian::Zero();
  jacobian.middleCols<3>(at_position).setIdentity();
  jacobian.middleCols<3>(at_velocity) = ahead_s * Matrix3d::Identity();
  jacobian.middleCols<3>(at_attitude) = rotation * cross_matrix(lever_arm_body_m);
  jacobian.middleCols<3>(at_lever_arm) = -rotation;
  return jacobian;
}

/// H of a fix times columns of the state.
template <int count>
Eigen::Matrix<double, 3, count> Filter::times_columns(const Eigen::Matrix<double, state_size, count>& columns,
                                                      double ahead_s) const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  const Matrix3d by_attitude = rotation * cross_matrix(lever_arm_body_m);
  return columns.template middleRows<3>(at_position) + ahead_s * columns.template middleRows<3>(at_velocity) +
         by_attitude * columns.template middleRows<3>(at_attitude) -
         rotation * columns.template middleRows<3>(at_lever_arm);
}

/// H P Hᵀ of a fix.
Matrix3d Filter::fix_covariance_of(const StateColumns& columns, double ahead_s) const {
  const Matrix3d whole = times_columns(columns, ahead_s);
  return 0.5 * (whole + whole.transpose());
}

Innovation Filter::fix_innovation(const Vector3d& fix_world_m, const Matrix3d& fix_covariance_m2,
                                  double ahead_s) const {
  Innovation innovation;
  ahead_s -= delay_error_s;
  const Quaterniond q_then =
      q_body_to_world * geometry::rotation_by((ahead_s * angular_velocity_body_radps).eval());
  const Vector3d predicted = position_world_m + ahead_s * velocity_world_mps +
                             0.5 * ahead_s * ahead_s * acceleration_world_mps2 - q_then * lever_arm_body_m;
  innovation.value_world_m = fix_world_m - predicted;
  innovation.columns = fix_columns(ahead_s);
  if (estimates_delay()) {
    // H of the delay is minus the velocity of the tracked point.
    const Vector3d h = q_then * angular_velocity_body_radps.cross(lever_arm_body_m) - velocity_world_mps -
                       ahead_s * acceleration_world_mps2;
    innovation.delay_row = times_columns(delay_covariance, ahead_s) + delay_variance_s2 * h;
    innovation.columns += delay_covariance * h.transpose();
    const Matrix3d by_delay = h * innovation.delay_row.transpose();
    innovation.covariance_m2 = 0.5 * (by_delay + by_delay.transpose());
  } else {
    innovation.covariance_m2.setZero();
  }
  innovation.covariance_m2 += fix_covariance_of(innovation.columns, ahead_s) + fix_covariance_m2;
  const Eigen::LLT<Matrix3d> factor(innovation.covariance_m2);
  if (factor.info() != Eigen::Success) {
    innovation.squared_norm = std::numeric_limits<double>::infinity();  // rejects it
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
  correct(w, whitened_innovation, w_delay);
}

/// H of a heading with respect to the attitude error. The direction of a body axis b = R a in the horizontal
/// plane turns by φ_z − b_z (b_x φ_x + b_y φ_y) / (b_x² + b_y²) for a small rotation φ = R δθ of the world.
Filter::HeadingRow Filter::heading_row(const Vector3d& axis_world) const {
  const double horizontal = axis_world.head<2>().squaredNorm();
  const Vector3d by_world(-axis_world.z() * axis_world.x() / horizontal,
                          -axis_world.z() * axis_world.y() / horizontal, 1.0);
  return by_world.transpose() * q_body_to_world.toRotationMatrix();
}

/// The direction of the pair's axis at a stamp `ahead_s` after the latest step.
Vector3d Filter::axis_world(double mount_rad, double ahead_s) const {
  const Quaterniond q_then =
      q_body_to_world *
      geometry::rotation_by(((ahead_s - delay_error_s) * angular_velocity_body_radps).eval());
  return q_then * Vector3d(std::cos(mount_rad), std::sin(mount_rad), 0.0);
}

Filter::HeadingInnovation Filter::heading_innovation(double heading_world_rad, double mount_rad,
                                                     double variance_rad2, double ahead_s) const {
  constexpr double least_horizontal = 0.1;
  const Vector3d axis = axis_world(mount_rad, ahead_s);
  HeadingInnovation innovation;
  innovation.observable = axis.head<2>().norm() > least_horizontal;
  if (!innovation.observable) return innovation;
  innovation.value_rad = geometry::wrap_angle(heading_world_rad - std::atan2(axis.y(), axis.x()));
  const HeadingRow row = heading_row(axis);
  const double h = -row.dot(angular_velocity_body_radps);  // of the delay
  innovation.row = row;
  innovation.column = covariance.middleCols<3>(at_attitude) * row.transpose();
  if (estimates_delay()) {
    innovation.column += h * delay_covariance;
    innovation.delay_row = row.dot(delay_covariance.segment<3>(at_attitude)) + h * delay_variance_s2;
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
             Scalar(innovation.delay_row / std_rad));
}

void Filter::correct_states(StateIndex index, const Vector3d& innovation, double variance) {
  const StateColumns columns = covariance.middleCols<3>(index);
  const Matrix3d s = columns.middleRows<3>(index) + variance * Matrix3d::Identity();
  const Eigen::LLT<Matrix3d> factor(s);
  if (factor.info() != Eigen::Success) return;
  const StateColumns w = whitened(columns, factor);
  const Vector3d whitened_innovation = factor.matrixL().solve(innovation);
  const Vector3d w_delay = factor.matrixL().solve(delay_covariance.segment<3>(index));
  correct(w, whitened_innovation, w_delay);
}

void Filter::add_variance(StateIndex index, const Vector3d& variance) {
  covariance.diagonal().segment<3>(index) += variance;
}

void Filter::decorrelate(StateIndex index, const Vector3d& variance) {
  covariance.middleRows<3>(index).setZero();
  covariance.middleCols<3>(index).setZero();
  covariance.diagonal().segment<3>(index) = variance;
  delay_covariance.segment<3>(index).setZero();
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
  }
  mirror_upper(covariance);
}

void Filter::estimate_delay(double variance_s2) {
  delay_covariance.setZero();
  delay_variance_s2 = variance_s2;
  if (variance_s2 == 0.0) delay_error_s = 0.0;
}

void Filter::add_yaw_variance(double variance_rad2) {
  const Vector3d up_body = geometry::up_in_body(q_body_to_world);
  const Matrix3d about_up = up_body * up_body.transpose();  // first, so that the sum stays symmetric
  covariance.block<3, 3>(at_attitude, at_attitude) += variance_rad2 * about_up;
}

/// P ← P − W Wᵀ, and the error W e is injected, where e is the innovation times L⁻¹. `w_delay` is the row of
/// W of the delay.
template <int rows>
void Filter::correct(const Eigen::Matrix<double, state_size, rows>& w,
                     const Eigen::Matrix<double, rows, 1>& innovation,
                     const Eigen::Matrix<double, rows, 1>& w_delay) {
  constexpr double most_delay_error_s = 0.06;
  constexpr double least_delay_std_s = 1e-5;
  const StateVector error = w * innovation;
  covariance -= w.lazyProduct(w.transpose());
  inject(error);
  if (!estimates_delay()) return;
  delay_covariance -= w * w_delay;
  delay_variance_s2 =
      std::max(delay_variance_s2 - w_delay.squaredNorm(), least_delay_std_s * least_delay_std_s);
  delay_error_s =
      std::clamp(delay_error_s + w_delay.dot(innovation), -most_delay_error_s, most_delay_error_s);
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

Covariance<6> Filter::pose_covariance() const {
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  // The covariance may be older than the state: the velocity's share has grown since.
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
  // Of v − R (ω × l).
  const Matrix3d rotation = q_body_to_world.toRotationMatrix();
  const Matrix3d by_attitude = rotation * cross_matrix(angular_velocity_body_radps.cross(lever_arm_body_m));
  const Matrix3d by_gyro_bias = -rotation * cross_matrix(lever_arm_body_m);
  const Matrix3d by_lever_arm = -rotation * cross_matrix(angular_velocity_body_radps);
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

bool Filter::is_finite() const {
  return position_world_m.allFinite() && velocity_world_mps.allFinite() &&
         q_body_to_world.coeffs().allFinite() && covariance.diagonal().allFinite();
}

}  // namespace sonopose::estimation::kalman
