#pragma once
/// \file
/// Settings of the attitude filters, with their defaults. docs/settings.md explains each.

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::attitude {

enum class FilterKind : std::uint8_t { adaptive, mahony, complementary, ahrs, gyro };
constexpr std::array<std::string_view, 5> choices_of(FilterKind /*unused*/) {
  return {"adaptive", "mahony", "complementary", "ahrs", "gyro"};
}

/// Correction by the magnetometer in the Mahony filter.
enum class MagneticError : std::uint8_t {
  heading,  ///< yaw alone: a disturbed field cannot tilt the estimate
  full      ///< all three axes, as in the classic filter
};
constexpr std::array<std::string_view, 2> choices_of(MagneticError /*unused*/) {
  return {"heading", "full"};
}

/// Reaction to a sensor that was ignored for too long (rejection.hpp).
enum class RejectionForm {
  recovery,  ///< the sensor is used again until it agrees
  seed       ///< the accelerometer restarts the initialisation; the magnetometer sets the heading
};
constexpr std::array<std::string_view, 2> choices_of(RejectionForm /*unused*/) {
  return {"recovery", "seed"};
}

/// Choice of the attitude filter, and its use of the magnetometer.
struct SelectionSettings {
  FilterKind filter = FilterKind::adaptive;
  bool magnetometer = false;
  double north_deg = 90.0;
};

/// Mahony filter (mahony.hpp).
struct MahonySettings {
  double kp = 0.01;   ///< item 29
  double ki = 0.001;  ///< item 30
  double ki_gate_mps2 = 0.5;
  MagneticError magnetic_error = MagneticError::heading;
  double heading_kp = 0.05;
};

/// Time constants of the adaptive filter (adaptive.hpp).
struct AdaptiveSettings {
  double accel_time_s = 3.0;
  double heading_time_s = 9.0;
};

/// Rest detection (rest.hpp).
struct RestSettings {
  double rate_limit_dps = 2.0;
  double force_limit_mps2 = 0.5;
  double still_s = 1.5;
  double smoothing_s = 0.5;
};

/// Estimation of the gyroscope offset (bias.hpp).
struct BiasSettings {
  double initial_dps = 0.5;
  double limit_dps = 2.0;
  double wander_s = 100.0;
  double rest_dps = 0.03;
  double motion_dps = 0.08;
  double unseen_dps = 10.0;
};

/// Detection of magnetic disturbances (magnetic.hpp).
struct MagneticSettings {
  double norm_tolerance = 0.1;
  double dip_tolerance_deg = 10.0;
  double undisturbed_s = 0.5;
  double first_field_s = 5.0;
  double new_field_s = 20.0;
  double new_field_rate_dps = 20.0;
  double longest_rejection_s = 60.0;
  double late_share = 0.1;
  double reference_s = 20.0;
  double smoothing_s = 0.05;
};

/// Complementary filter (complementary.hpp).
struct ComplementarySettings {
  double alpha = 0.999;
  double alpha_step_s = 0.01;
};

/// AHRS (ahrs.hpp).
struct AhrsSettings {
  double gain = 0.5;
  double acceleration_rejection_deg = 10.0;
  double magnetic_rejection_deg = 20.0;
  double rejection_timeout_s = 5.0;
  RejectionForm rejection = RejectionForm::recovery;
  bool gyro_offset = true;
  double gyro_offset_limit_dps = 3.0;
  double gyro_offset_still_s = 5.0;
  double gyro_offset_cutoff_hz = 0.02;
  double gyro_range_dps = 0.0;
};

/// Adaptive filter and its parts.
struct AdaptiveFilterSettings {
  AdaptiveSettings adaptive;
  RestSettings rest;
  BiasSettings bias;
  MagneticSettings magnetic;
};

/// Choice of the filter, and the settings of each.
struct Settings {
  SelectionSettings selection;
  AdaptiveFilterSettings adaptive;
  MahonySettings mahony;
  ComplementarySettings complementary;
  AhrsSettings ahrs;
};

}  // namespace sonopose::attitude
