#pragma once
/// \file
/// Magnetometer, in its own axes: m_c = S·m_u − h with the symmetric soft-iron matrix S and the hard-iron
/// offset h, which is taken off after S. What iron that turns with the sensor does to a field of constant
/// strength makes its readings an ellipsoid; where that is centred at c, h is S·c.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/settings/declaration.hpp>

#include <string_view>

namespace sonopose::calibration {

struct MagnetometerSettings {
  double soft_iron_xx{};
  double soft_iron_xy{};
  double soft_iron_xz{};
  double soft_iron_yy{};
  double soft_iron_yz{};
  double soft_iron_zz{};
  double hard_iron_x_ut{};
  double hard_iron_y_ut{};
  double hard_iron_z_ut{};

  static constexpr std::string_view group = "calibration.magnetometer";
  static constexpr auto declarations() {
    using G = MagnetometerSettings;
    using settings::own_setting;
    using settings::real;
    constexpr auto stretch = [](std::string_view name, double G::*field, std::string_view sentence) {
      return real(own_setting, name, field, 1.0, {0.01, 100.0}, "", sentence);
    };
    constexpr auto mixture = [](std::string_view name, double G::*field, std::string_view sentence) {
      return real(own_setting, name, field, 0.0, {-100.0, 100.0}, "", sentence);
    };
    constexpr auto offset = [](std::string_view name, double G::*field, std::string_view sentence) {
      return real(own_setting, name, field, 0.0, {-10000.0, 10000.0}, "uT", sentence);
    };
    return settings::rows(
        stretch("soft_iron_xx", &G::soft_iron_xx,
                "Soft-iron matrix, which is symmetric: factor of the sensor's X axis."),
        mixture("soft_iron_xy", &G::soft_iron_xy, "Soft-iron matrix: share of Y in X and of X in Y."),
        mixture("soft_iron_xz", &G::soft_iron_xz, "Soft-iron matrix: share of Z in X and of X in Z."),
        stretch("soft_iron_yy", &G::soft_iron_yy, "Soft-iron matrix: factor of the sensor's Y axis."),
        mixture("soft_iron_yz", &G::soft_iron_yz, "Soft-iron matrix: share of Z in Y and of Y in Z."),
        stretch("soft_iron_zz", &G::soft_iron_zz, "Soft-iron matrix: factor of the sensor's Z axis."),
        offset("hard_iron_x_ut", &G::hard_iron_x_ut,
               "Hard-iron offset of the sensor's X axis, taken off after the soft-iron matrix."),
        offset("hard_iron_y_ut", &G::hard_iron_y_ut, "Hard-iron offset of the sensor's Y axis."),
        offset("hard_iron_z_ut", &G::hard_iron_z_ut, "Hard-iron offset of the sensor's Z axis."));
  }
  constexpr MagnetometerSettings() { settings::set_defaults(*this); }
};

/// The model in the sensor's own axes, in tesla.
Affine model_of(const MagnetometerSettings& settings);

}  // namespace sonopose::calibration
