#pragma once
/// \file
/// Rest, as the adaptive filter sees it: rate and specific force have hardly left their own means for some
/// time. Then the mean rate is the gyroscope's offset, the best estimate of it that there is.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/settings/declaration.hpp>

namespace sonopose::attitude {

struct RestSettings {
  double rate_limit_dps{};
  double force_limit_mps2{};
  double still_s{};
  double smoothing_s{};

  static constexpr std::string_view group = "attitude.rest";
  static constexpr auto declarations() {
    using G = RestSettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(real(own_setting, "rate_limit_dps", &G::rate_limit_dps, 2.0, {0.0, 100.0}, "deg/s",
                              "At rest the angular rate stays within this of its mean."),
                         real(own_setting, "force_limit_mps2", &G::force_limit_mps2, 0.5, {0.0, 10.0},
                              "m/s^2", "At rest the specific force stays within this of its mean."),
                         real(own_setting, "still_s", &G::still_s, 1.5, {0.1, 60.0}, "s",
                              "It is rest when it has been so for this long."),
                         real(own_setting, "smoothing_s", &G::smoothing_s, 0.5, {0.01, 10.0}, "s",
                              "Time constant of these means."));
  }
  constexpr RestSettings() { settings::set_defaults(*this); }
};

template <class Scalar>
struct RestState {
  Vector3<Scalar> rate_mean_body_radps = Vector3<Scalar>::Zero();
  Vector3<Scalar> force_mean_body_mps2 = Vector3<Scalar>::Zero();
  Scalar age_s = 0;        ///< of the means, up to their time constant
  Scalar still_for_s = 0;  ///< since the last sample that was no rest

  bool operator==(const RestState&) const = default;
};

namespace rest {

/// Takes one measurement in, `dt_s` after the one before. `most_bias_radps`: a mean rate beyond it, about any
/// axis, is a turn.
template <class Scalar>
void watch(const RestSettings& settings, RestState<Scalar>& state, const Measurement<Scalar>& measurement,
           Scalar dt_s, Scalar most_bias_radps);

template <class Scalar>
bool is_resting(const RestSettings& settings, const RestState<Scalar>& state);

}  // namespace rest
}  // namespace sonopose::attitude
