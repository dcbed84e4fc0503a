#pragma once
/// \file
/// The Mahony filter (settings 29, 30; the attitude document's "Mahony Filter"): the gyroscope integrated,
/// with a proportional and integral pull of the estimated up towards the measured specific force, and of the
/// estimated north towards the measured field.

#include <sonopose/attitude/integrated_attitude.hpp>
#include <sonopose/settings/declaration.hpp>

#include <array>
#include <cstdint>

namespace sonopose::attitude {

/// What the magnetometer may turn.
enum class MagneticError : std::uint8_t {
  heading,  ///< yaw alone: a disturbed field cannot tilt the estimate
  full      ///< the classic error of all three axes
};

constexpr std::array<std::string_view, 2> choices_of(MagneticError /*kind*/) {
  return {"heading", "full"};
}

/// Items 29 and 30.
struct MahonySettings {
  double kp{};
  double ki{};
  double ki_gate_mps2{};
  MagneticError magnetic_error{};
  double heading_kp{};

  static constexpr std::string_view group = "attitude.mahony";
  static constexpr auto declarations() {
    using G = MahonySettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(
            29, "kp", &G::kp, 0.01, {0.0, 10.0}, "1/s",
            "Speed at which tilt is corrected towards the measured gravity; higher reacts faster and is more "
            "easily misled by acceleration."),
        real(30, "ki", &G::ki, 0.001, {0.0, 0.1}, "1/s^2",
             "Rate at which a remaining gyro offset is learned from the tilt correction, over tens of "
             "seconds."),
        real(own_setting, "ki_gate_mps2", &G::ki_gate_mps2, 0.5, {0.0, 1000.0}, "m/s^2",
             "The offset is learned only while the specific force differs from gravity by less than this: in "
             "a long turn the tilt correction is wrong all the time in one direction."),
        settings::choice(own_setting, "magnetic_error", &G::magnetic_error, MagneticError::heading,
                        "What the magnetometer corrects: heading alone, or, as the filter was first written, "
                        "the full error of all three axes with the gain kp."),
        real(own_setting, "heading_kp", &G::heading_kp, 0.05, {0.0, 10.0}, "1/s",
             "Speed at which heading is corrected towards the magnetometer's, where it corrects heading "
             "alone."));
  }
  constexpr MahonySettings() { settings::set_defaults(*this); }
};

/// Its offset of the gyroscope is the integral, with its sign turned.
template <class Number>
class BasicMahony : public IntegratedAttitude<Number> {
public:
  using Scalar = Number;
  using Settings = MahonySettings;
  static constexpr std::string_view name = "mahony";

  ///   e = v_measured × v_estimated;  ω' = ω + Kp·e + Ki·∫e dt;  q ← q ⊗ exp(ω'·dt)
  /// The exponential is exact where the document's q̇ = ½ q ⊗ ω is of first order.
  void update(const Settings& settings, const Measurement<Scalar>& measurement);
};

extern template class BasicMahony<float>;
extern template class BasicMahony<double>;

using Mahony = BasicMahony<double>;

}  // namespace sonopose::attitude
