#pragma once
/// \file
/// The complementary filter (the attitude document's "Complementary Filter"). It blends the gyroscope's
/// prediction with the measurements of accelerometer and magnetometer.

#include <sonopose/attitude/integrated_attitude.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

/// The filter uses the given gyroscope offset and learns none.
template <class Number>
class BasicComplementary : public IntegratedAttitude<Number> {
public:
  using Scalar = Number;
  using Settings = ComplementarySettings;
  static constexpr std::string_view name = "complementary";

  /// One step: θ ← α·(θ + ω·dt) + (1 − α)·θ_measured.
  /// The document blends Euler angles. That holds only near level, where ω is their rate. Here the predicted
  /// orientation first turns by (1 − α) of the angle between its up and the measured one, about the axis
  /// across both. It then turns about the vertical by (1 − α) of the angle between the level part of the
  /// field and north. About a single axis this is the same, and it is correct at any attitude.
  void update(const Settings& settings, const Measurement<Scalar>& measurement);
};

extern template class BasicComplementary<float>;
extern template class BasicComplementary<double>;

using Complementary = BasicComplementary<double>;

}  // namespace sonopose::attitude
