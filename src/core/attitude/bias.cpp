#include <sonopose/attitude/bias.hpp>

#include <Eigen/LU>

namespace sonopose::attitude::bias {
namespace {

template <class Scalar>
Scalar radps(double dps) {
  return Scalar(dps * geometry::radians_per_degree);
}

/// Kalman update b ← b + K·e, with |e| and |b| held within the limit: K = P·Cᵀ·(C·P·Cᵀ + W)⁻¹, P ← P − K·C·P.
template <class Scalar>
void correct(BiasState<Scalar>& state, const Matrix3<Scalar>& seen, Vector3<Scalar> error_radps,
             const Vector3<Scalar>& variance, Scalar limit_radps) {
  const Vector3<Scalar> limit = Vector3<Scalar>::Constant(limit_radps);
  error_radps = error_radps.cwiseMax(-limit).cwiseMin(limit);
  Matrix3<Scalar> innovation = seen * state.covariance * seen.transpose();
  innovation.diagonal() += variance;
  const Matrix3<Scalar> gain = state.covariance * seen.transpose() * innovation.inverse();
  state.bias_body_radps += gain * error_radps;
  state.bias_body_radps = state.bias_body_radps.cwiseMax(-limit).cwiseMin(limit).eval();
  state.covariance -= (gain * seen * state.covariance).eval();
}

}  // namespace

template <class Scalar>
Scalar limit_radps(const BiasSettings& settings) {
  return radps<Scalar>(settings.limit_dps);
}

template <class Scalar>
void estimate(const BiasSettings& settings, BiasState<Scalar>& state, const BiasEvidence<Scalar>& evidence) {
  const Scalar span_s = state.span_s;
  const Matrix3<Scalar> rotation = state.rotation_s / span_s;
  const Vector3<Scalar> turn_rate_world_radps = state.turned_world_rad / span_s;
  state.span_s = 0;
  state.rotation_s.setZero();
  state.turned_world_rad.setZero();
  state.late_rotation.update(rotation, span_s, evidence.accel_time_s);
  state.late_bias_world.update(rotation * state.bias_body_radps, span_s, evidence.accel_time_s);

  const Scalar max_variance = radps<Scalar>(settings.initial_dps) * radps<Scalar>(settings.initial_dps);
  if (!state.begun) state.covariance = max_variance * Matrix3<Scalar>::Identity();
  state.begun = true;
  const Scalar wander = radps<Scalar>(0.1) * radps<Scalar>(0.1) * span_s / Scalar(settings.wander_s);
  for (int axis = 0; axis < 3; ++axis) {
    if (state.covariance(axis, axis) < max_variance) state.covariance(axis, axis) += wander;
  }
  // Variance of one measurement for which the estimate's variance settles at `dps`² while the offset wanders.
  const auto variance_for = [wander](double dps) {
    const Scalar settled = radps<Scalar>(dps) * radps<Scalar>(dps);
    return settled * settled / wander + settled;
  };
  const auto limit = limit_radps<Scalar>(settings);
  if (evidence.at_rest) {
    const Vector3<Scalar> error = evidence.rate_mean_body_radps - state.bias_body_radps;
    correct<Scalar>(state, Matrix3<Scalar>::Identity(), error,
                    Vector3<Scalar>::Constant(variance_for(settings.rest_dps)), limit);
  } else if (evidence.levelled) {
    // An offset error δ turns the estimate by −R·δ per second, and the accelerometer corrects as much.
    const Matrix3<Scalar>& seen = state.late_rotation.value;
    Vector3<Scalar> error =
        state.late_bias_world.value - turn_rate_world_radps - seen * state.bias_body_radps;
    error.z() = -(seen.row(2) * state.bias_body_radps)(0);
    const Scalar level = variance_for(settings.motion_dps);
    correct<Scalar>(state, seen, error, {level, level, variance_for(settings.unseen_dps)}, limit);
  }
}

template float limit_radps(const BiasSettings&);
template double limit_radps(const BiasSettings&);
template void estimate(const BiasSettings&, BiasState<float>&, const BiasEvidence<float>&);
template void estimate(const BiasSettings&, BiasState<double>&, const BiasEvidence<double>&);

}  // namespace sonopose::attitude::bias
