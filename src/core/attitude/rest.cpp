#include <sonopose/attitude/rest.hpp>

namespace sonopose::attitude::rest {

template <class Scalar>
void update(const RestSettings& settings, RestState<Scalar>& state, const Measurement<Scalar>& measurement,
            Scalar dt_s, Scalar max_bias_radps) {
  // A plain mean at first, then an exponential one.
  const Scalar memory_s = state.age_s + dt_s;
  const Scalar share = memory_s > 0 ? dt_s / memory_s : Scalar(1);
  state.age_s = std::min(memory_s, Scalar(settings.smoothing_s));
  const Vector3<Scalar> rate_off = measurement.angular_velocity_body_radps - state.rate_mean_body_radps;
  const Vector3<Scalar> force_off = measurement.specific_force_body_mps2 - state.force_mean_body_mps2;
  state.rate_mean_body_radps += share * rate_off;
  state.force_mean_body_mps2 += share * force_off;

  const auto rate_limit_radps = Scalar(settings.rate_limit_dps * geometry::radians_per_degree);
  const auto force_limit_mps2 = Scalar(settings.force_limit_mps2);
  const bool still = rate_off.squaredNorm() <= rate_limit_radps * rate_limit_radps &&
                     force_off.squaredNorm() <= force_limit_mps2 * force_limit_mps2 &&
                     state.rate_mean_body_radps.cwiseAbs().maxCoeff() <= max_bias_radps;
  // Saturate: a float would lose precision within a day.
  state.still_for_s = still ? std::min(state.still_for_s + dt_s, Scalar(settings.still_s)) : Scalar(0);
}

template <class Scalar>
bool is_resting(const RestSettings& settings, const RestState<Scalar>& state) {
  return state.still_for_s >= Scalar(settings.still_s);
}

template void update(const RestSettings&, RestState<float>&, const Measurement<float>&, float, float);
template void update(const RestSettings&, RestState<double>&, const Measurement<double>&, double, double);
template bool is_resting(const RestSettings&, const RestState<float>&);
template bool is_resting(const RestSettings&, const RestState<double>&);

}  // namespace sonopose::attitude::rest
