#pragma once
/// \file
/// The complementary filter (the attitude document's "Complementary Filter"): what the gyroscope predicts and
/// what accelerometer and magnetometer measure, blended.

#include <sonopose/attitude/integrated_attitude.hpp>
#include <sonopose/settings/declaration.hpp>

namespace sonopose::attitude {

struct ComplementarySettings {
  double alpha{};
  double alpha_step_s{};

  static constexpr std::string_view group = "attitude.complementary";
  static constexpr auto declarations() {
    using G = ComplementarySettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(own_setting, "alpha", &G::alpha, 0.999, {0.0, 1.0}, "",
             "Share of the gyroscope's prediction in the orientation; the rest is what accelerometer and "
             "magnetometer measure."),
        real(own_setting, "alpha_step_s", &G::alpha_step_s, 0.01, {1e-5, 10.0}, "s",
             "The time step that alpha is meant for; over another one it counts as often as it fits in."));
  }
  constexpr ComplementarySettings() { settings::set_defaults(*this); }
};

/// Its offset is the one that was given: the filter learns none.
template <class Number>
class BasicComplementary : public IntegratedAttitude<Number> {
public:
  using Scalar = Number;
  using Settings = ComplementarySettings;
  static constexpr std::string_view name = "complementary";

  ///   θ ← α·(θ + ω·dt) + (1 − α)·θ_measured
  /// The document blends Euler angles, which holds near level alone, where ω is their rate. Here the
  /// predicted orientation is turned by (1 − α) of the angle between its up and the measured one, about the
  /// axis across both, and then about the vertical by (1 − α) of the angle between the level part of the
  /// field and north: for one axis the same, and right at any attitude.
  void update(const Settings& settings, const Measurement<Scalar>& measurement);
};

extern template class BasicComplementary<float>;
extern template class BasicComplementary<double>;

using Complementary = BasicComplementary<double>;

}  // namespace sonopose::attitude
