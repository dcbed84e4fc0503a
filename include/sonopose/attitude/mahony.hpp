#pragma once
/// \file
/// The Mahony filter (settings 29, 30; the attitude document's "Mahony Filter"). It integrates the gyroscope.
/// A proportional and an integral term pull the estimated up towards the measured specific force, and the
/// estimated north towards the measured field.

#include <sonopose/attitude/integrated_attitude.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

/// The filter's gyroscope offset is the negative of the integral.
template <class Number>
class BasicMahony : public IntegratedAttitude<Number> {
public:
  using Scalar = Number;
  using Settings = MahonySettings;
  static constexpr std::string_view name = "mahony";

  /// One step:
  ///   e = v_measured × v_estimated;  ω' = ω + Kp·e + Ki·∫e dt;  q ← q ⊗ exp(ω'·dt)
  /// The exponential is exact; the document's q̇ = ½ q ⊗ ω is of first order.
  void update(const Settings& settings, const Measurement<Scalar>& measurement);
};

extern template class BasicMahony<float>;
extern template class BasicMahony<double>;

using Mahony = BasicMahony<double>;

}  // namespace sonopose::attitude
