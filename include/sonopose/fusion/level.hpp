#pragma once
/// \file
/// Levelling by the fixes, beyond the document: a velocity that the fixes must correct again and again in one
/// direction is an acceleration that is not there, and that comes from a wrong tilt (or, along the vertical,
/// from the accelerometer). It lets item 29 be low, so that long turns do not mislead the tilt.

#include <sonopose/attitude/mahony.hpp>
#include <sonopose/core/samples.hpp>
#include <sonopose/core/setting.hpp>

namespace sonopose::fusion {

struct LevelSettings {
  double tilt_gain_hz{};
  double vertical_gain_hz{};
  double max_vertical_mps2{};

  static constexpr std::string_view group = "level";
  static constexpr auto declarations() {
    using G = LevelSettings;
    using setting::own_setting;
    using setting::real;
    return std::tuple{
        real(own_setting, "tilt_gain_hz", &G::tilt_gain_hz, 0.0, {0.0, 10.0}, "1/s",
             "Rate at which the velocity corrections by fixes level the attitude; 0: they never do."),
        real(own_setting, "vertical_gain_hz", &G::vertical_gain_hz, 0.0, {0.0, 10.0}, "1/s",
             "Rate at which vertical velocity corrections by fixes are learned as an offset of the vertical "
             "acceleration."),
        real(own_setting, "max_vertical_mps2", &G::max_vertical_mps2, 0.5, {0.0, 10.0}, "m/s^2",
             "Largest offset of the vertical acceleration that is learned.")};
  }
  constexpr LevelSettings() { setting::set_defaults(*this); }
};

struct LevelState {
  double vertical_offset_mps2 = 0;  ///< to be added to the vertical acceleration

  bool operator==(const LevelState&) const = default;
};

namespace level {

/// Takes what a fix has changed of the velocity: a horizontal change dv turns the attitude by gain · dv / g
/// about the horizontal axis across it, a vertical one changes the offset by gain · dv.
void learn(const LevelSettings& settings, LevelState& state, attitude::Mahony& filter,
           const Vector3d& velocity_change_world_mps);

}  // namespace level
}  // namespace sonopose::fusion
