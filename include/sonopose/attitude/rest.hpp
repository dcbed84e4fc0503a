#pragma once
/// \file
/// Rest detection of the adaptive filter. The body rests if rate and specific force have stayed close to
/// their means for some time. The mean rate is then the best estimate of the gyroscope offset.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

template <class Scalar>
struct RestState {
  Vector3<Scalar> rate_mean_body_radps = Vector3<Scalar>::Zero();
  Vector3<Scalar> force_mean_body_mps2 = Vector3<Scalar>::Zero();
  Scalar age_s = 0;        ///< age of the means, up to their time constant
  Scalar still_for_s = 0;  ///< time since the last sample in motion

  bool operator==(const RestState&) const = default;
};

namespace rest {

/// Adds one measurement, `dt_s` after the previous one. A mean rate beyond `max_bias_radps` about any axis is
/// a turn.
template <class Scalar>
void update(const RestSettings& settings, RestState<Scalar>& state, const Measurement<Scalar>& measurement,
            Scalar dt_s, Scalar max_bias_radps);

template <class Scalar>
bool is_resting(const RestSettings& settings, const RestState<Scalar>& state);

}  // namespace rest
}  // namespace sonopose::attitude
