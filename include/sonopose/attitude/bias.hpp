#pragma once
/// \file
/// The gyroscope offset, estimated by a small Kalman filter. At rest it uses the mean rate. In motion it uses
/// the accelerometer's repeated tilt corrections. They make the offset observable about the two axes that are
/// level at the time.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/low_pass.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

template <class Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

template <class Scalar>
struct BiasState {
  Vector3<Scalar> bias_body_radps = Vector3<Scalar>::Zero();
  Matrix3<Scalar> covariance =
      Matrix3<Scalar>::Zero();  ///< covariance of the offset; zero until the first estimate
  bool begun = false;
  // Sums since the last estimate.
  Scalar span_s = 0;
  Matrix3<Scalar> rotation_s = Matrix3<Scalar>::Zero();        ///< ∫R(q) dt
  Vector3<Scalar> turned_world_rad = Vector3<Scalar>::Zero();  ///< sum of the tilt corrections
  // Delayed by the accelerometer's low-pass filter, like the corrections.
  LowPass<Matrix3<Scalar>> late_rotation;    ///< R(q)
  LowPass<Vector3<Scalar>> late_bias_world;  ///< R(q)·bias

  bool operator==(const BiasState&) const = default;
};

namespace bias {

/// Interval between estimates: much shorter than changes of an offset, much longer than the sample period.
inline constexpr double period_s = 0.1;

/// Adds one step: the orientation, and the rotation (rad, world) that levelled it.
template <class Scalar>
void collect(BiasState<Scalar>& state, const Matrix3<Scalar>& rotation_body_to_world,
             const Vector3<Scalar>& turn_world_rad, Scalar dt_s) {
  state.span_s += dt_s;
  state.rotation_s += dt_s * rotation_body_to_world;
  state.turned_world_rad += turn_world_rad;
}

template <class Scalar>
bool is_due(const BiasState<Scalar>& state) {
  return state.span_s >= Scalar(period_s);
}

/// Further inputs of an estimate: the mean rate if the body is at rest, and the low-pass filter that delays
/// tilt corrections.
template <class Scalar>
struct BiasEvidence {
  bool at_rest = false;
  bool levelled = false;  ///< true once the low-pass filter has settled and corrections are meaningful
  Vector3<Scalar> rate_mean_body_radps = Vector3<Scalar>::Zero();
  Scalar accel_time_s = 0;
};

/// Largest offset that is learned (rad/s).
template <class Scalar>
Scalar limit_radps(const BiasSettings& settings);

/// Estimates once from the sums, then restarts them.
template <class Scalar>
void estimate(const BiasSettings& settings, BiasState<Scalar>& state, const BiasEvidence<Scalar>& evidence);

}  // namespace bias
}  // namespace sonopose::attitude
