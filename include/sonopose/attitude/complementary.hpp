#pragma once
/// \file
/// The complementary filter (the attitude document's "Complementary Filter"): what the gyroscope predicts and
/// what accelerometer and magnetometer measure, blended.

#include <sonopose/attitude/integrated_attitude.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

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
  /// field and north: the same for one axis, and correct at any attitude.
  void update(const Settings& settings, const Measurement<Scalar>& measurement);
};

extern template class BasicComplementary<float>;
extern template class BasicComplementary<double>;

using Complementary = BasicComplementary<double>;

}  // namespace sonopose::attitude
