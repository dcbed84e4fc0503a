#pragma once
/// \file
/// Gyroscope and accelerometer, each in its own axes: i_c = M·s·(i_u − b) with the offset b, the diagonal
/// matrix of sensitivities s and the misalignment M, whose diagonal is 1.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/settings/declaration.hpp>

#include <string_view>

namespace sonopose::calibration {

/// What both sensors have in common: s, and M without its diagonal, by row and column.
struct InertialTerms {
  double sensitivity_x{};
  double sensitivity_y{};
  double sensitivity_z{};
  double misalignment_xy{};
  double misalignment_xz{};
  double misalignment_yx{};
  double misalignment_yz{};
  double misalignment_zx{};
  double misalignment_zy{};
};

namespace detail {

template <class G>
constexpr auto sensitivity(std::string_view name, double G::*field, std::string_view sentence) {
  return settings::real<G>(settings::own_setting, name, field, 1.0, {0.1, 10.0}, "", sentence);
}

template <class G>
constexpr auto misalignment(std::string_view name, double G::*field, std::string_view sentence) {
  return settings::real<G>(settings::own_setting, name, field, 0.0, {-0.5, 0.5}, "", sentence);
}

/// The rows of InertialTerms for the group G, which has them as its base.
template <class G>
constexpr auto inertial_declarations() {
  return settings::rows(
      sensitivity<G>("sensitivity_x", &G::sensitivity_x,
                     "Factor of the sensor's X axis, after the offset was taken off."),
      sensitivity<G>("sensitivity_y", &G::sensitivity_y, "Factor of the sensor's Y axis."),
      sensitivity<G>("sensitivity_z", &G::sensitivity_z, "Factor of the sensor's Z axis."),
      misalignment<G>("misalignment_xy", &G::misalignment_xy,
                      "Share of the Y axis, after its sensitivity, that is added to X."),
      misalignment<G>("misalignment_xz", &G::misalignment_xz, "Share of the Z axis that is added to X."),
      misalignment<G>("misalignment_yx", &G::misalignment_yx, "Share of the X axis that is added to Y."),
      misalignment<G>("misalignment_yz", &G::misalignment_yz, "Share of the Z axis that is added to Y."),
      misalignment<G>("misalignment_zx", &G::misalignment_zx, "Share of the X axis that is added to Z."),
      misalignment<G>("misalignment_zy", &G::misalignment_zy, "Share of the Y axis that is added to Z."));
}

}  // namespace detail

struct GyroscopeSettings : InertialTerms {
  double offset_x_radps{};
  double offset_y_radps{};
  double offset_z_radps{};

  static constexpr std::string_view group = "calibration.gyroscope";
  static constexpr auto declarations() {
    using G = GyroscopeSettings;
    constexpr auto offset = [](std::string_view name, double G::*field, std::string_view sentence) {
      return settings::real(settings::own_setting, name, field, 0.0, {-2.0, 2.0}, "rad/s", sentence);
    };
    return settings::joined(
        settings::rows(
            offset(
                "offset_x_radps", &G::offset_x_radps,
                "What the sensor's X axis tells at rest, taken off first; the start-up calibration takes off "
                "what is left."),
            offset("offset_y_radps", &G::offset_y_radps, "What the sensor's Y axis tells at rest."),
            offset("offset_z_radps", &G::offset_z_radps, "What the sensor's Z axis tells at rest.")),
        detail::inertial_declarations<G>());
  }
  constexpr GyroscopeSettings() { settings::set_defaults(*this); }
};

struct AccelerometerSettings : InertialTerms {
  double offset_x_mps2{};
  double offset_y_mps2{};
  double offset_z_mps2{};

  static constexpr std::string_view group = "calibration.accelerometer";
  static constexpr auto declarations() {
    using G = AccelerometerSettings;
    constexpr auto offset = [](std::string_view name, double G::*field, std::string_view sentence) {
      return settings::real(settings::own_setting, name, field, 0.0, {-20.0, 20.0}, "m/s^2", sentence);
    };
    return settings::joined(
        settings::rows(
            offset("offset_x_mps2", &G::offset_x_mps2,
                   "What the sensor's X axis tells in free fall; it is taken off first."),
            offset("offset_y_mps2", &G::offset_y_mps2, "What the sensor's Y axis tells in free fall."),
            offset("offset_z_mps2", &G::offset_z_mps2, "What the sensor's Z axis tells in free fall.")),
        detail::inertial_declarations<G>());
  }
  constexpr AccelerometerSettings() { settings::set_defaults(*this); }
};

/// The models in the sensors' own axes, in rad/s and m/s².
Affine model_of(const GyroscopeSettings& settings);
Affine model_of(const AccelerometerSettings& settings);

}  // namespace sonopose::calibration
