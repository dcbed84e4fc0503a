#pragma once
/// \file
/// Settings of the AHRS (ahrs.hpp).

#include <sonopose/settings/declaration.hpp>

#include <array>
#include <string_view>

namespace sonopose::attitude {

/// What happens when a sensor has been ignored for too long (rejection.hpp).
enum class RejectionForm {
  recovery,  ///< it is used again until it agrees
  seed       ///< the accelerometer's restarts the initialisation, the magnetometer's sets the heading
};
constexpr std::array<std::string_view, 2> choices_of(RejectionForm /*unused*/) {
  return {"recovery", "seed"};
}

struct AhrsSettings {
  double gain{};
  double acceleration_rejection_deg{};
  double magnetic_rejection_deg{};
  double rejection_timeout_s{};
  RejectionForm rejection{};
  bool gyro_offset{};
  double gyro_offset_limit_dps{};
  double gyro_offset_still_s{};
  double gyro_offset_cutoff_hz{};
  double gyro_range_dps{};

  static constexpr std::string_view group = "attitude.ahrs";
  static constexpr auto declarations() {
    using G = AhrsSettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(own_setting, "gain", &G::gain, 0.5, {0.0, 10.0}, "1/s",
             "Speed at which tilt and heading follow the accelerometer and the magnetometer; 0 is the "
             "gyroscope alone."),
        real(own_setting, "acceleration_rejection_deg", &G::acceleration_rejection_deg, 10.0, {0.0, 180.0},
             "deg",
             "The accelerometer is ignored while its up is further than this from the estimated one; 0 never "
             "ignores it."),
        real(own_setting, "magnetic_rejection_deg", &G::magnetic_rejection_deg, 20.0, {0.0, 180.0}, "deg",
             "The magnetometer is ignored while its heading is further than this from the estimated one; 0 "
             "never ignores it."),
        real(own_setting, "rejection_timeout_s", &G::rejection_timeout_s, 5.0, {0.0, 3600.0}, "s",
             "How long a sensor may be ignored; 0 never ignores any."),
        settings::choice(own_setting, "rejection", &G::rejection, RejectionForm::recovery,
                        "After that time: recovery uses the sensor until it agrees, seed restarts the "
                        "initialisation or sets the heading."),
        settings::flag(own_setting, "gyro_offset", &G::gyro_offset, true,
                      "The gyroscope's offset is learned while the body stands still."),
        real(own_setting, "gyro_offset_limit_dps", &G::gyro_offset_limit_dps, 3.0, {0.0, 100.0}, "deg/s",
             "The body stands still while no rate exceeds this, the offset so far taken off."),
        real(own_setting, "gyro_offset_still_s", &G::gyro_offset_still_s, 5.0, {0.0, 3600.0}, "s",
             "How long it must have stood still before the offset is learned."),
        real(own_setting, "gyro_offset_cutoff_hz", &G::gyro_offset_cutoff_hz, 0.02, {0.0001, 10.0}, "Hz",
             "Cut-off of the low-pass filter that learns the offset."),
        real(own_setting, "gyro_range_dps", &G::gyro_range_dps, 0.0, {0.0, 100000.0}, "deg/s",
             "Range of the gyroscope; a rate beyond 98 % of it, where the sensor may clip, starts the "
             "initialisation again; 0 for a range that is never reached."));
  }
  constexpr AhrsSettings() { settings::set_defaults(*this); }
};

}  // namespace sonopose::attitude
