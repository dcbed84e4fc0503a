#pragma once
/// \file
/// How the sensor is mounted, in right angles: which of the sensor's axes each axis of the body is.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/settings/declaration.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::calibration {

/// A place in the list of names below. A name tells the sensor's axes along body X, Y and Z in this order:
/// with "+y-x+z" body X is the sensor's +Y, body Y its −X and body Z its +Z.
enum class Axes : std::uint8_t { as_mounted };

/// All that turn a right-handed sensor into a right-handed body.
constexpr std::array<std::string_view, 24> choices_of(Axes /*unused*/) {
  return {"+x+y+z", "+x-y-z", "+x+z-y", "+x-z+y", "-x+y-z", "-x-y+z", "-x+z+y", "-x-z-y",
          "+y+x-z", "+y-x+z", "+y+z+x", "+y-z-x", "-y+x+z", "-y-x-z", "-y+z-x", "-y-z+x",
          "+z+x+y", "+z-x-y", "+z+y-x", "+z-y+x", "-z+x-y", "-z-x+y", "-z+y+x", "-z-y-x"};
}

struct AxesSettings {
  Axes axes{};

  static constexpr std::string_view group = "calibration";
  static constexpr auto declarations() {
    using G = AxesSettings;
    return settings::rows(settings::choice(
        settings::own_setting, "axes", &G::axes, Axes::as_mounted,
        "The sensor's axes along body X, Y and Z: with +y-x+z body X is the sensor's +Y, body Y its -X and "
        "body Z its +Z. Gyroscope, accelerometer and magnetometer are turned alike, after their calibration, "
        "which is in the sensor's axes."));
  }
  constexpr AxesSettings() { settings::set_defaults(*this); }
};

/// R of v_body = R·v_sensor.
Matrix3d sensor_to_body(const AxesSettings& settings);

}  // namespace sonopose::calibration
