#pragma once
/// \file
/// Settings of the sensor model, with their defaults, which change nothing. docs/settings.md explains each.

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::calibration {

/// Mounting of the sensor, an index into the names below. A name lists the sensor's axes along body X, Y and
/// Z: with "+y-x+z" body X is the sensor's +Y, body Y its −X and body Z its +Z.
enum class Axes : std::uint8_t { as_mounted };

/// All mountings that turn a right-handed sensor into a right-handed body.
constexpr std::array<std::string_view, 24> choices_of(Axes /*unused*/) {
  return {"+x+y+z", "+x-y-z", "+x+z-y", "+x-z+y", "-x+y-z", "-x-y+z", "-x+z+y", "-x-z-y",
          "+y+x-z", "+y-x+z", "+y+z+x", "+y-z-x", "-y+x+z", "-y-x-z", "-y+z-x", "-y-z+x",
          "+z+x+y", "+z-x-y", "+z+y-x", "+z-y+x", "-z+x-y", "-z-x+y", "-z+y+x", "-z-y-x"};
}

struct AxesSettings {
  Axes axes = Axes::as_mounted;
};

/// Terms common to gyroscope and accelerometer (inertial.hpp): the sensitivities, and the misalignment
/// without its diagonal, by row and column.
struct InertialTerms {
  double sensitivity_x = 1.0;
  double sensitivity_y = 1.0;
  double sensitivity_z = 1.0;
  double misalignment_xy = 0.0;
  double misalignment_xz = 0.0;
  double misalignment_yx = 0.0;
  double misalignment_yz = 0.0;
  double misalignment_zx = 0.0;
  double misalignment_zy = 0.0;
};

struct GyroscopeSettings : InertialTerms {
  double offset_x_radps = 0.0;
  double offset_y_radps = 0.0;
  double offset_z_radps = 0.0;
};

struct AccelerometerSettings : InertialTerms {
  double offset_x_mps2 = 0.0;
  double offset_y_mps2 = 0.0;
  double offset_z_mps2 = 0.0;
};

/// Symmetric soft-iron matrix and hard-iron offset (magnetometer.hpp).
struct MagnetometerSettings {
  double soft_iron_xx = 1.0;
  double soft_iron_xy = 0.0;
  double soft_iron_xz = 0.0;
  double soft_iron_yy = 1.0;
  double soft_iron_yz = 0.0;
  double soft_iron_zz = 1.0;
  double hard_iron_x_ut = 0.0;
  double hard_iron_y_ut = 0.0;
  double hard_iron_z_ut = 0.0;
};

struct Settings {
  AxesSettings axes;
  GyroscopeSettings gyroscope;
  AccelerometerSettings accelerometer;
  MagnetometerSettings magnetometer;
};

}  // namespace sonopose::calibration
