#pragma once
/// \file
/// The gyroscope's offset, estimated by a small Kalman filter: at rest from the mean rate; in motion from
/// what the accelerometer must correct of the tilt again and again, which shows the two axes that are level
/// just then.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/low_pass.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

template <class Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

template <class Scalar>
struct BiasState {
  Vector3<Scalar> bias_body_radps = Vector3<Scalar>::Zero();
  Matrix3<Scalar> covariance = Matrix3<Scalar>::Zero();  ///< of it; zero until the first estimate
  bool begun = false;
  // Sums since the last estimate.
  Scalar span_s = 0;
  Matrix3<Scalar> rotation_s = Matrix3<Scalar>::Zero();        ///< ∫R(q) dt
  Vector3<Scalar> turned_world_rad = Vector3<Scalar>::Zero();  ///< corrections made
  // As late as the corrections are: what has passed through the accelerometer's low-pass.
  LowPass<Matrix3<Scalar>> late_rotation;    ///< R(q)
  LowPass<Vector3<Scalar>> late_bias_world;  ///< R(q)·bias

  bool operator==(const BiasState&) const = default;
};

namespace bias {

/// How often an estimate is made: far oftener than any offset changes, far less often than samples come.
inline constexpr double period_s = 0.1;

/// Takes in one step: the orientation, and the turn (rad, world) by which it was levelled.
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

/// What the filter knows besides: the mean rate, where the body rests, and the low-pass that lies between a
/// wrong tilt and its correction.
template <class Scalar>
struct BiasEvidence {
  bool at_rest = false;
  bool levelled = false;  ///< the low-pass has settled, so that corrections mean something
  Vector3<Scalar> rate_mean_body_radps = Vector3<Scalar>::Zero();
  Scalar accel_time_s = 0;
};

/// The largest offset that is learned, rad/s.
template <class Scalar>
Scalar limit_radps(const BiasSettings& settings);

/// One estimate from what was collected; then restarts the collection.
template <class Scalar>
void estimate(const BiasSettings& settings, BiasState<Scalar>& state, const BiasEvidence<Scalar>& evidence);

}  // namespace bias
}  // namespace sonopose::attitude
