#include <sonopose/attitude/gyro_offset.hpp>

#include <numbers>

namespace sonopose::attitude {

template <class Scalar>
void GyroOffset<Scalar>::learn(const GyroOffsetLimits<Scalar>& limits,
                               const geometry::Vector3<Scalar>& angular_velocity_body_radps, Scalar dt_s) {
  const geometry::Vector3<Scalar> remainder_radps = angular_velocity_body_radps - offset_body_radps;
  if (remainder_radps.cwiseAbs().maxCoeff() > limits.rate_radps) {
    still_s = 0;
    return;
  }
  if (still_s < limits.still_s) {
    still_s += dt_s;
    return;
  }
  // Low-pass filter by the backward rule, stable at any step.
  const Scalar x = 2 * std::numbers::pi_v<Scalar> * limits.cutoff_hz * dt_s;
  offset_body_radps += (x / (1 + x)) * remainder_radps;
}

template struct GyroOffset<float>;
template struct GyroOffset<double>;

}  // namespace sonopose::attitude
