#pragma once
/// \file
/// One error-state Kalman filter: a nominal state at the IMU and the covariance of its error. The equations
/// are those of docs/kalman.md.

#include <sonopose/estimation/kalman/at_most_one.hpp>
#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <array>

namespace sonopose::estimation::kalman {

using Eigen::Matrix3d;

/// Rows of the error state. The attitude error is a rotation about the body axes.
enum StateIndex : int {
  at_position = 0,     ///< position of the IMU, world
  at_velocity = 3,     ///< velocity of the IMU, world
  at_attitude = 6,     ///< attitude error, body
  at_gyro_bias = 9,    ///< bias, body
  at_accel_bias = 12,  ///< bias, body
  at_lever_arm = 15,   ///< lever arm, body
  state_size = 18
};

using StateCovariance = Eigen::Matrix<double, state_size, state_size>;
using StateVector = Eigen::Matrix<double, state_size, 1>;
using FixJacobian = Eigen::Matrix<double, 3, state_size>;
using StateColumns = Eigen::Matrix<double, state_size, 3>;

/// Spectral densities of the process noise.
struct ProcessNoise {
  double accel_mps2_rthz = 0.003;
  double gyro_radps_rthz = 2e-4;
  double accel_bias_mps2_rts = 4e-4;
  double gyro_bias_radps_rts = 1e-4;
  double delay_s_rts = 1e-4;         ///< used if the delay is estimated
  double velocity_scale_rts = 5e-4;  ///< used once velocities are measured
};

/// Unmeasured motion: white acceleration and angular rate, and a decaying velocity.
struct UnknownMotion {
  double velocity_time_constant_s = 1.0;  ///< time constant of the velocity
  double accel_mps2_rthz = 2.0;
  double tilt_rad_rts = 0.1;
  double yaw_rad_rts = 0.6;
};

/// A fix minus its prediction by a filter.
struct Innovation {
  Vector3d value_world_m = Vector3d::Zero();
  Matrix3d covariance_m2 = Matrix3d::Identity();  ///< S = H P Hᵀ + R
  StateColumns columns = StateColumns::Zero();    ///< P Hᵀ
  Vector3d delay_row = Vector3d::Zero();          ///< row of P Hᵀ for the delay
  Vector3d scale_row = Vector3d::Zero();          ///< row of P Hᵀ for the scale of measured velocities
  double squared_norm = 0;                        ///< normalised by S
  double log_determinant = 0;                     ///< log-determinant of S
};

/// Parts of the Jacobian Φ of several steps: sums over the steps, in the world frame.
struct Transition {
  double duration_s = 0;                               ///< duration of the steps
  double position_velocity_s = 0;                      ///< ∂p/∂v
  Matrix3d rotation_start = Matrix3d::Identity();      ///< body to world, before the first step
  Vector3d impulse_mps = Vector3d::Zero();             ///< Σ Δt f
  Vector3d impulse_sum_m = Vector3d::Zero();           ///< Σ Δt impulse
  Matrix3d rotation_sum_s = Matrix3d::Zero();          ///< Σ Δt R
  Matrix3d rotation_double_sum_s2 = Matrix3d::Zero();  ///< Σ Δt rotation_sum
  Matrix3d velocity_gyro_bias = Matrix3d::Zero();      ///< ∂v/∂b_g
  Matrix3d position_gyro_bias = Matrix3d::Zero();      ///< ∂p/∂b_g

  bool operator==(const Transition&) const = default;
};

struct NominalState {
  Vector3d position_world_m = Vector3d::Zero();  ///< position of the IMU
  Vector3d velocity_world_mps = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
  Vector3d acceleration_world_mps2 =
      Vector3d::Zero();  ///< acceleration over the latest step, without gravity
  Vector3d angular_velocity_body_radps = Vector3d::Zero();  ///< rate over the latest step, without the bias

  bool operator==(const NominalState&) const = default;
};

/// One IMU step.
struct NominalStep {
  NominalState after;
  Matrix3d rotation_middle;  ///< body to world, in the middle of the step
  Vector3d force_world_mps2;
};

/// Scale error of measured velocities, which are 1 + `error` times the true ones: a further row and column.
struct VelocityScale {
  double error = 0;
  double variance = 0;
  double delay_covariance_s = 0;  ///< covariance with the delay error
  StateVector covariance = StateVector::Zero();

  bool operator==(const VelocityScale&) const = default;
};

inline constexpr double max_scale_error = 0.15;

/// A velocity along one body axis, and its prediction by a filter.
struct VelocityInnovation {
  double value_mps = 0;
  double variance_m2ps2 = 1;                 ///< S = H P Hᵀ + R
  double estimated_mps = 0;                  ///< true velocity, by the filter
  StateVector column = StateVector::Zero();  ///< P Hᵀ
  double delay_row = 0;                      ///< row of P Hᵀ for the delay
  double scale_row = 0;                      ///< row of P Hᵀ for the scale
};

/// Nominal state and its covariance. A plain value; no function throws or allocates.
class Filter : public NominalState {
public:
  Vector3d gyro_bias_body_radps = Vector3d::Zero();
  Vector3d accel_bias_body_mps2 = Vector3d::Zero();
  Vector3d lever_arm_body_m = Vector3d::Zero();  ///< from the tracked point to the IMU
  StateCovariance covariance = StateCovariance::Zero();
  // The delay error is an optional further row and column, kept apart so that it costs nothing when off.
  double delay_error_s = 0;                            ///< age of fixes and headings beyond their stamps
  double delay_variance_s2 = 0;                        ///< 0: not estimated
  StateVector delay_covariance = StateVector::Zero();  ///< covariance of the state with the delay
  AtMostOne<VelocityScale> scale;                      ///< there once a velocity was measured
  bool ignores_force = false;                          ///< the velocity stays; the accelerometer is not used
  Transition pending;                                  ///< transition since the covariance was propagated

  bool operator==(const Filter&) const = default;

  /// Computes one step from a nominal state, with the biases of this filter and the mean rate and specific
  /// force over the step.
  [[nodiscard]] NominalStep step(const NominalState& from, const Vector3d& rate_body_radps,
                                 const Vector3d& specific_force_body_mps2, double dt_s) const;

  /// Moves the nominal state by one step with the mean rate and specific force over it, and composes the
  /// transition. `propagate` then updates the covariance.
  void predict(const Vector3d& rate_body_radps, const Vector3d& specific_force_body_mps2, double dt_s);

  /// Moves the state and its covariance over a time without samples. The covariance must have been
  /// propagated.
  void predict_without_imu(double duration_s, const UnknownMotion& motion);

  /// Jacobian Φ of all steps since the last `propagate`.
  [[nodiscard]] StateCovariance transition() const;

  /// Propagates the covariance over all steps since the last call: P ← Φ P Φᵀ + Q.
  void propagate(const ProcessNoise& noise);

  /// Innovation of a position of the tracked point, or of `point_body_m` seen from it, measured `ahead_s`
  /// after the latest step.
  [[nodiscard]] Innovation fix_innovation(const Vector3d& position_world_m, const Matrix3d& fix_covariance_m2,
                                          double ahead_s,
                                          const Vector3d& point_body_m = Vector3d::Zero()) const;

  /// Jacobian H of a fix measured `ahead_s` after the latest step.
  [[nodiscard]] FixJacobian fix_jacobian(double ahead_s,
                                         const Vector3d& point_body_m = Vector3d::Zero()) const;

  /// Corrects the state by a fix with this innovation, which `fix_innovation` must have returned for the
  /// current state. `more_covariance_m2` is added to the covariance of the fix.
  void correct_fix(const Innovation& innovation, const Matrix3d& more_covariance_m2 = Matrix3d::Zero());

  /// Innovation of the direction of a horizontal body axis at `mount_rad` from body X, and its variance.
  struct HeadingInnovation {
    double value_rad = 0;
    double variance_rad2 = 1;
    bool observable = false;  ///< false if the axis is nearly vertical
    Eigen::RowVector3d row =
        Eigen::RowVector3d::Zero();            ///< H of the attitude error; zero for all other states
    StateVector column = StateVector::Zero();  ///< P Hᵀ
    double delay_row = 0;                      ///< row of P Hᵀ for the delay
    double scale_row = 0;                      ///< row of P Hᵀ for the scale of measured velocities
  };
  [[nodiscard]] HeadingInnovation heading_innovation(double heading_world_rad, double mount_rad,
                                                     double variance_rad2, double ahead_s) const;
  void correct_heading(double heading_world_rad, double mount_rad, double variance_rad2, double ahead_s);

  /// Innovation of the velocity along a body axis of the point `from_tracked_body_m`, measured `ahead_s`
  /// after the latest step. With `is_scaled`, the scale error applies.
  [[nodiscard]] VelocityInnovation velocity_innovation(int axis, double velocity_mps, double variance_m2ps2,
                                                       const Vector3d& from_tracked_body_m, bool is_scaled,
                                                       double ahead_s) const;
  /// Corrects the state by this innovation, of the current state. `more_variance_m2ps2` is added to the
  /// variance of the measurement.
  void correct_velocity(const VelocityInnovation& innovation, double more_variance_m2ps2);

  /// Corrects by a direct measurement of the three states from `index` on. `innovation` is measured minus
  /// estimated; `variance` is that of each component.
  void update_direct(StateIndex index, const Vector3d& innovation, double variance);

  /// Adds an error to the nominal state. The covariance stays as it is.
  void inject(const StateVector& error);

  /// Adds to position and velocity what the errors of attitude and biases have caused in this time. The
  /// covariance must have been propagated.
  void apply_past_errors(double duration_s);

  /// Adds to the variance of three states.
  void add_variance(StateIndex index, const Vector3d& variance);
  /// Adds the variance of a motion s times this one, where s has a standard deviation of 1.
  void add_uncertain_motion(const Vector3d& impulse_body_mps, const Vector3d& turn_body_rad);

  /// Turns position, velocity and attitude, and their covariance, about the vertical through the origin.
  void turn_world(double angle_rad);

  /// Removes three states' correlations and sets their variances.
  void decorrelate(StateIndex index, const Vector3d& variance);

  /// Estimates the error of the delay from now on, with this variance; 0: takes the stamps as they are.
  void estimate_delay(double variance_s2);
  [[nodiscard]] bool estimates_delay() const { return delay_variance_s2 > 0.0; }

  /// Adds yaw variance: a rotation about world Z.
  void add_yaw_variance(double variance_rad2);

  [[nodiscard]] Vector3d tracked_position_world_m() const { return tracked_position_world_m(*this); }
  [[nodiscard]] Vector3d tracked_velocity_world_mps() const { return tracked_velocity_world_mps(*this); }
  /// Position of another state's tracked point, with the lever arm of this filter.
  [[nodiscard]] Vector3d tracked_position_world_m(const NominalState& state) const {
    return state.position_world_m - state.q_body_to_world * lever_arm_body_m;
  }
  [[nodiscard]] Vector3d tracked_velocity_world_mps(const NominalState& state) const {
    return state.velocity_world_mps -
           state.q_body_to_world * state.angular_velocity_body_radps.cross(lever_arm_body_m);
  }
  /// Covariance of the tracked point's position and of the rotation about the fixed world axes.
  [[nodiscard]] Covariance<6> pose_covariance() const;
  /// Covariance of the tracked point's velocity v − R(ω × l), world.
  [[nodiscard]] Covariance<3> velocity_covariance() const;
  [[nodiscard]] double yaw_variance_rad2() const;
  [[nodiscard]] bool is_finite() const;

private:
  void begin_transition();
  void add_process_noise(const ProcessNoise& noise);
  [[nodiscard]] StateColumns fix_columns(double ahead_s) const;
  template <int count>
  [[nodiscard]] Eigen::Matrix<double, 3, count> times_columns(
      const Eigen::Matrix<double, state_size, count>& columns, double ahead_s) const;
  [[nodiscard]] Vector3d fix_delay_column(const Quaterniond& q_then, double ahead_s) const;
  [[nodiscard]] Matrix3d fix_covariance_of(const StateColumns& columns, double ahead_s) const;
  using HeadingRow = Eigen::Matrix<double, 1, 3>;
  [[nodiscard]] HeadingRow heading_row(const Vector3d& axis_world) const;
  [[nodiscard]] Vector3d axis_world(double mount_rad, double ahead_s) const;
  template <int rows>
  void correct(const Eigen::Matrix<double, state_size, rows>& w,
               const Eigen::Matrix<double, rows, 1>& innovation,
               const Eigen::Matrix<double, rows, 1>& w_delay, const Eigen::Matrix<double, rows, 1>& w_scale);
};

void for_each_field(IsFieldsOf<Transition> auto& transition, const auto& visit) {
  visit("duration_s", transition.duration_s);
  visit("position_velocity_s", transition.position_velocity_s);
  visit("rotation_start", transition.rotation_start);
  visit("impulse_mps", transition.impulse_mps);
  visit("impulse_sum_m", transition.impulse_sum_m);
  visit("rotation_sum_s", transition.rotation_sum_s);
  visit("rotation_double_sum_s2", transition.rotation_double_sum_s2);
  visit("velocity_gyro_bias", transition.velocity_gyro_bias);
  visit("position_gyro_bias", transition.position_gyro_bias);
}

/// Visits the parts of a covariance of the state with another one.
void for_each_part(auto& column, const std::array<const char*, 6>& names, const auto& visit) {
  for (int i = 0; i < 6; ++i) {
    Vector3d part = column.template segment<3>(3 * i);
    visit(names[static_cast<std::size_t>(i)], part);
    if constexpr (!std::is_const_v<std::remove_reference_t<decltype(column)>>) {
      column.template segment<3>(3 * i) = part;
    }
  }
}

void for_each_field(IsFieldsOf<VelocityScale> auto& scale, const auto& visit) {
  visit("error", scale.error);
  visit("variance", scale.variance);
  visit("delay_covariance", scale.delay_covariance_s);  // may be negative
  for_each_part(scale.covariance,
                {"covariance.position", "covariance.velocity", "covariance.attitude", "covariance.gyro_bias",
                 "covariance.accel_bias", "covariance.lever_arm"},
                visit);
}

/// Visits the fields of a filter. In every stored state, all filters have made all steps up to the latest
/// sample.
void for_each_field(IsFieldsOf<Filter> auto& filter, const auto& visit) {
  visit("position_world_m", filter.position_world_m);
  visit("velocity_world_mps", filter.velocity_world_mps);
  visit("q_body_to_world", filter.q_body_to_world);
  visit("gyro_bias_body_radps", filter.gyro_bias_body_radps);
  visit("accel_bias_body_mps2", filter.accel_bias_body_mps2);
  visit("lever_arm_body_m", filter.lever_arm_body_m);
  visit("delay_error_s", filter.delay_error_s);
  visit("delay_variance_s2", filter.delay_variance_s2);
  for_each_part(filter.delay_covariance,
                {"delay_covariance.position", "delay_covariance.velocity", "delay_covariance.attitude",
                 "delay_covariance.gyro_bias", "delay_covariance.accel_bias", "delay_covariance.lever_arm"},
                visit);
  visit("covariance", filter.covariance);
  for_each_field(filter.pending, visit);
  visit("acceleration_world_mps2", filter.acceleration_world_mps2);
  visit("angular_velocity_body_radps", filter.angular_velocity_body_radps);
  visit("velocity_scale", filter.scale);
  visit("ignores_force", filter.ignores_force);
}

}  // namespace sonopose::estimation::kalman
