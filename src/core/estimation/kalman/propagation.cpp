// Prediction of a filter: its nominal state and the covariance of its error.

#include "estimation/kalman/filter_internal.hpp"
#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

auto columns_at(const StateCovariance& covariance, StateIndex index) {
  return covariance.middleCols<3>(index);
}

template <class Columns>
auto rows_at(const Columns& columns, StateIndex index) {
  return columns.template middleRows<3>(index);
}

/// Three columns of the covariance times the transpose of a block of Φ.
template <class Columns>
auto times(const Columns& columns, const Matrix3d& block) {
  return columns.lazyProduct(block.transpose());
}

/// Blocks of Φ that are neither zero nor the identity, and products with them.
struct TransitionBlocks {
  double position_velocity_s;
  Matrix3d position_attitude;
  Matrix3d position_gyro_bias;
  Matrix3d position_accel_bias;
  Matrix3d velocity_attitude;
  Matrix3d velocity_gyro_bias;
  Matrix3d velocity_accel_bias;
  Matrix3d attitude_attitude;
  Matrix3d attitude_gyro_bias;

  TransitionBlocks(const Transition& sums, const Quaterniond& q_body_to_world)
      : position_velocity_s(sums.position_velocity_s),
        position_attitude(-geometry::cross_matrix(sums.impulse_sum_m) * sums.rotation_start),
        position_gyro_bias(sums.position_gyro_bias),
        position_accel_bias(-sums.rotation_double_sum_s2),
        velocity_attitude(-geometry::cross_matrix(sums.impulse_mps) * sums.rotation_start),
        velocity_gyro_bias(sums.velocity_gyro_bias),
        velocity_accel_bias(-sums.rotation_sum_s) {
    const Matrix3d to_body = q_body_to_world.toRotationMatrix().transpose();
    attitude_attitude = to_body * sums.rotation_start;
    attitude_gyro_bias = -to_body * sums.rotation_sum_s;
  }

  // Three columns of P Φᵀ.
  [[nodiscard]] StateColumns position_columns(const StateCovariance& covariance) const {
    return columns_at(covariance, at_position) + position_velocity_s * columns_at(covariance, at_velocity) +
           times(columns_at(covariance, at_attitude), position_attitude) +
           times(columns_at(covariance, at_gyro_bias), position_gyro_bias) +
           times(columns_at(covariance, at_accel_bias), position_accel_bias);
  }
  [[nodiscard]] StateColumns velocity_columns(const StateCovariance& covariance) const {
    return columns_at(covariance, at_velocity) +
           times(columns_at(covariance, at_attitude), velocity_attitude) +
           times(columns_at(covariance, at_gyro_bias), velocity_gyro_bias) +
           times(columns_at(covariance, at_accel_bias), velocity_accel_bias);
  }
  [[nodiscard]] StateColumns attitude_columns(const StateCovariance& covariance) const {
    return times(columns_at(covariance, at_attitude), attitude_attitude) +
           times(columns_at(covariance, at_gyro_bias), attitude_gyro_bias);
  }

  // Three rows of Φ times columns of the state.
  template <int count>
  [[nodiscard]] Eigen::Matrix<double, 3, count> times_position_rows(
      const Eigen::Matrix<double, state_size, count>& columns) const {
    return rows_at(columns, at_position) + position_velocity_s * rows_at(columns, at_velocity) +
           position_attitude.lazyProduct(rows_at(columns, at_attitude)) +
           position_gyro_bias.lazyProduct(rows_at(columns, at_gyro_bias)) +
           position_accel_bias.lazyProduct(rows_at(columns, at_accel_bias));
  }
  template <int count>
  [[nodiscard]] Eigen::Matrix<double, 3, count> times_velocity_rows(
      const Eigen::Matrix<double, state_size, count>& columns) const {
    return rows_at(columns, at_velocity) + velocity_attitude.lazyProduct(rows_at(columns, at_attitude)) +
           velocity_gyro_bias.lazyProduct(rows_at(columns, at_gyro_bias)) +
           velocity_accel_bias.lazyProduct(rows_at(columns, at_accel_bias));
  }
  template <int count>
  [[nodiscard]] Eigen::Matrix<double, 3, count> times_attitude_rows(
      const Eigen::Matrix<double, state_size, count>& columns) const {
    return attitude_attitude.lazyProduct(rows_at(columns, at_attitude)) +
           attitude_gyro_bias.lazyProduct(rows_at(columns, at_gyro_bias));
  }
};

}  // namespace

NominalStep Filter::step(const NominalState& from, const Vector3d& rate_body_radps,
                         const Vector3d& specific_force_body_mps2, double dt_s) const {
  NominalStep step;
  NominalState& after = step.after;
  after.angular_velocity_body_radps = rate_body_radps - gyro_bias_body_radps;
  const Quaterniond half = geometry::rotation_by((0.5 * dt_s * after.angular_velocity_body_radps).eval());
  const Quaterniond q_middle = from.q_body_to_world * half;
  step.rotation_middle = q_middle.toRotationMatrix();
  step.force_world_mps2.setZero();
  after.acceleration_world_mps2.setZero();
  if (!ignores_force) {
    step.force_world_mps2 = step.rotation_middle * (specific_force_body_mps2 - accel_bias_body_mps2);
    after.acceleration_world_mps2 = step.force_world_mps2 + gravity_world_mps2;
  }
  after.position_world_m = from.position_world_m + dt_s * from.velocity_world_mps +
                           0.5 * dt_s * dt_s * after.acceleration_world_mps2;
  after.velocity_world_mps = from.velocity_world_mps + dt_s * after.acceleration_world_mps2;
  after.q_body_to_world = (q_middle * half).normalized();
  return step;
}

void Filter::predict(const Vector3d& rate_body_radps, const Vector3d& specific_force_body_mps2, double dt_s) {
  const NominalStep step = this->step(*this, rate_body_radps, specific_force_body_mps2, dt_s);
  // In the world frame only the gyro bias changes an attitude error.
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
  static_cast<NominalState&>(*this) = step.after;
}

void Filter::begin_transition() {
  if (pending.duration_s == 0.0) pending.rotation_start = q_body_to_world.toRotationMatrix();
}

void Filter::predict_without_imu(double duration_s, const UnknownMotion& motion) {
  const double tau_s = motion.velocity_time_constant_s;
  const double decay = std::exp(-duration_s / tau_s);
  const double moving_s = tau_s * (1.0 - decay);
  position_world_m += moving_s * velocity_world_mps;
  velocity_world_mps *= decay;
  acceleration_world_mps2.setZero();
  angular_velocity_body_radps.setZero();

  StateCovariance& P = covariance;  // NOLINT(readability-identifier-naming): the symbol of the equations
  P.middleRows<3>(at_position) += moving_s * P.middleRows<3>(at_velocity);
  P.middleRows<3>(at_velocity) *= decay;
  P.middleCols<3>(at_position) += moving_s * P.middleCols<3>(at_velocity);
  P.middleCols<3>(at_velocity) *= decay;
  delay_covariance.segment<3>(at_position) += moving_s * delay_covariance.segment<3>(at_velocity);
  delay_covariance.segment<3>(at_velocity) *= decay;
  if (scale) {
    scale->covariance.segment<3>(at_position) += moving_s * scale->covariance.segment<3>(at_velocity);
    scale->covariance.segment<3>(at_velocity) *= decay;
  }
  // Integrals of white acceleration with a decaying velocity.
  const double accel = motion.accel_mps2_rthz * motion.accel_mps2_rthz;
  P.diagonal().segment<3>(at_position).array() +=
      accel * tau_s * tau_s * (duration_s - 2.0 * moving_s + 0.5 * tau_s * (1.0 - decay * decay));
  for (int i = 0; i < 3; ++i) P(at_position + i, at_velocity + i) += 0.5 * accel * moving_s * moving_s;
  P.diagonal().segment<3>(at_velocity).array() += 0.5 * accel * tau_s * (1.0 - decay * decay);
  P.diagonal().segment<3>(at_attitude).array() += motion.tilt_rad_rts * motion.tilt_rad_rts * duration_s;
  add_yaw_variance(motion.yaw_rad_rts * motion.yaw_rad_rts * duration_s);
  mirror_upper(P);
}

void Filter::apply_past_errors(double duration_s) {
  if (!(duration_s > 0.0)) return;
  begin_transition();
  pending.duration_s = duration_s;
  pending.impulse_mps = duration_s * (acceleration_world_mps2 - gravity_world_mps2);
  pending.impulse_sum_m = 0.5 * duration_s * pending.impulse_mps;
  pending.rotation_sum_s = duration_s * pending.rotation_start;
  pending.rotation_double_sum_s2 = 0.5 * duration_s * pending.rotation_sum_s;
  propagate({0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
}

StateCovariance Filter::transition() const {
  StateCovariance transition = StateCovariance::Identity();
  if (!(pending.duration_s > 0.0)) return transition;
  const TransitionBlocks f(pending, q_body_to_world);
  const auto block = [&transition](StateIndex row, StateIndex column) {
    return transition.block<3, 3>(row, column);
  };
  block(at_position, at_velocity) = f.position_velocity_s * Matrix3d::Identity();
  block(at_position, at_attitude) = f.position_attitude;
  block(at_position, at_gyro_bias) = f.position_gyro_bias;
  block(at_position, at_accel_bias) = f.position_accel_bias;
  block(at_velocity, at_attitude) = f.velocity_attitude;
  block(at_velocity, at_gyro_bias) = f.velocity_gyro_bias;
  block(at_velocity, at_accel_bias) = f.velocity_accel_bias;
  block(at_attitude, at_attitude) = f.attitude_attitude;
  block(at_attitude, at_gyro_bias) = f.attitude_gyro_bias;
  return transition;
}

void Filter::propagate(const ProcessNoise& noise) {
  if (!(pending.duration_s > 0.0)) return;
  const TransitionBlocks f(pending, q_body_to_world);
  StateCovariance& P = covariance;  // NOLINT(readability-identifier-naming): the symbol of the equations
  // P Φᵀ by the columns of position, velocity and attitude.
  const StateColumns position = f.position_columns(P);
  const StateColumns velocity = f.velocity_columns(P);
  const StateColumns attitude = f.attitude_columns(P);
  // Φ (P Φᵀ): the blocks that change; of the first nine rows, the upper triangle.
  P.block<3, 3>(at_position, at_position) = f.times_position_rows(position);
  P.block<3, 3>(at_position, at_velocity) = f.times_position_rows(velocity);
  P.block<3, 3>(at_position, at_attitude) = f.times_position_rows(attitude);
  P.block<3, 3>(at_velocity, at_velocity) = f.times_velocity_rows(velocity);
  P.block<3, 3>(at_velocity, at_attitude) = f.times_velocity_rows(attitude);
  P.block<3, 3>(at_attitude, at_attitude) = f.times_attitude_rows(attitude);
  P.block<9, 3>(at_gyro_bias, at_position) = position.bottomRows<9>();
  P.block<9, 3>(at_gyro_bias, at_velocity) = velocity.bottomRows<9>();
  P.block<9, 3>(at_gyro_bias, at_attitude) = attitude.bottomRows<9>();
  P.topRightCorner<9, 9>() = P.bottomLeftCorner<9, 9>().transpose();
  add_process_noise(noise);
  mirror_upper<9>(P);
  if (estimates_delay()) {
    const StateVector before = delay_covariance;
    delay_covariance.segment<3>(at_position) = f.times_position_rows(before);
    delay_covariance.segment<3>(at_velocity) = f.times_velocity_rows(before);
    delay_covariance.segment<3>(at_attitude) = f.times_attitude_rows(before);
    delay_variance_s2 += noise.delay_s_rts * noise.delay_s_rts * pending.duration_s;
  }
  if (scale) {
    const StateVector before = scale->covariance;
    scale->covariance.segment<3>(at_position) = f.times_position_rows(before);
    scale->covariance.segment<3>(at_velocity) = f.times_velocity_rows(before);
    scale->covariance.segment<3>(at_attitude) = f.times_attitude_rows(before);
    scale->variance += noise.velocity_scale_rts * noise.velocity_scale_rts * pending.duration_s;
  }
  pending = Transition{};
}

/// Adds Q to the upper triangle of P.
void Filter::add_process_noise(const ProcessNoise& noise) {
  const double t = pending.position_velocity_s;
  const double duration_s = pending.duration_s;
  StateCovariance& P = covariance;  // NOLINT(readability-identifier-naming): the symbol of the equations
  const double accel = noise.accel_mps2_rthz * noise.accel_mps2_rthz;
  const double velocity = accel * duration_s;
  P.diagonal().segment<3>(at_position).array() += velocity * t * t / 3.0;
  for (int i = 0; i < 3; ++i) P(at_position + i, at_velocity + i) += 0.5 * velocity * t;
  P.diagonal().segment<3>(at_velocity).array() += velocity;
  P.diagonal().segment<3>(at_attitude).array() += noise.gyro_radps_rthz * noise.gyro_radps_rthz * duration_s;
  P.diagonal().segment<3>(at_gyro_bias).array() +=
      noise.gyro_bias_radps_rts * noise.gyro_bias_radps_rts * duration_s;
  P.diagonal().segment<3>(at_accel_bias).array() +=
      noise.accel_bias_mps2_rts * noise.accel_bias_mps2_rts * duration_s;
}

}  // namespace sonopose::estimation::kalman
