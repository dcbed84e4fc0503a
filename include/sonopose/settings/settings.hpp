#pragma once
/// \file
/// All settings of one estimator with their defaults, one group per stage. Ranges, units and meanings are in
/// src/core/settings/settings_table.cpp and docs/settings.md. An item is the number of a setting in the
/// fusion document; settings without one are additions.

#include <sonopose/attitude/settings.hpp>
#include <sonopose/calibration/model/settings.hpp>

#include <array>
#include <string_view>

namespace sonopose::settings {

/// Estimator that fuses a beacon's events.
enum class EngineKind { documented, kalman };
constexpr std::array<std::string_view, 2> choices_of(EngineKind /*unused*/) {
  return {"documented", "kalman"};
}

enum class ImuWeight { low, medium, high, user };
constexpr std::array<std::string_view, 4> choices_of(ImuWeight /*unused*/) {
  return {"low", "medium", "high", "user"};
}

enum class DelaySource { measured, fixed };
constexpr std::array<std::string_view, 2> choices_of(DelaySource /*unused*/) {
  return {"measured", "fixed"};
}

enum class HeightSource { setting, fixes };
constexpr std::array<std::string_view, 2> choices_of(HeightSource /*unused*/) {
  return {"setting", "fixes"};
}

/// Choice of the estimator.
struct EngineSettings {
  EngineKind engine = EngineKind::kalman;
};

/// Item 1: the balance between the IMU and the ultrasound.
struct PresetSettings {
  ImuWeight imu_weight = ImuWeight::medium;  ///< item 1
};

/// Correction of the position by a fix.
struct DriftSettings {
  double decay_rate_hz = 1.5;             ///< item 2
  double jump_alpha = 0.32;               ///< item 4
  double velocity_smooth_rate_hz = 10.0;  ///< item 9
};

/// Correction of the velocity by fixes.
struct VelocitySettings {
  double blend_weight = 0.14;       ///< item 3
  bool overshoot_fix = true;        ///< item 7
  bool undershoot_fix = true;       ///< item 8
  double snap_min_speed_mps = 2.0;  ///< item 28
  double snap_max_bend_m = 0.08;
  bool accel_gate = false;                 ///< item 26
  double accel_gate_threshold_mps2 = 3.0;  ///< item 27
  double interval_min_s = 0.05;
  double interval_max_s = 1.0;
  double interval_wanted_s = 0.15;
};

/// Alignment of the attitude in motion, by velocity corrections.
struct AlignmentSettings {
  double tilt_gain_hz = 0.85;
  double vertical_gain_hz = 0.13;
  double vertical_limit_mps2 = 0.5;
  double yaw_gain = 0.2;
  double yaw_noise_mps = 0.4;
  double aiding_s = 20.0;
  double hold_s = 60.0;
};

/// Yaw from paired beacons and from the direction of motion.
struct HeadingSettings {
  double mount_offset_deg = 0.0;    ///< item 5
  double min_displacement_m = 0.1;  ///< item 31
  double max_correction_deg = 5.0;  ///< item 32
  double error_gain = 0.005;        ///< item 33
  double pair_gain_hz = 2.0;        ///< item 34
  double pair_bias_gain_hz2 = 0.15;
  double expires_s = 0.5;
};

/// Compensation of the delay of a fix.
struct DelaySettings {
  bool extrapolate = true;  ///< item 6
  double processing_s = 0.068;
  DelaySource source = DelaySource::measured;
  double correction_s = 0.0;
  bool estimate = false;
};

/// Measured velocities of the body.
struct TwistSettings {
  bool enabled = true;
  double std_mps = 0.05;
  double lateral_std_mps = 0.0;
  double vertical_std_mps = 0.0;
  double point_x_m = 0.0;
  double point_y_m = 0.0;
  double scale_std = 0.05;
};

/// Behaviour without fixes or without IMU samples.
struct OutageSettings {
  double velocity_decay_rate_hz = 1.0;  ///< item 10
  double stale_after_s = 1.0;           ///< item 11
  double imu_gap_s = 0.25;
};

/// Conditions on which the engine accepts a sample.
struct AdmissionSettings {
  double min_quality_percent = 50.0;  ///< item 12
  double max_position_m = 1e4;
  double max_specific_force_mps2 = 400.0;
  double max_angular_rate_radps = 80.0;
  double max_fix_age_s = 0.9;
};

/// Trust in a fix.
struct TrustSettings {
  double sigma_m = 0.15;                ///< item 13
  double min_weight = 0.003;            ///< item 14
  bool enabled = true;                  ///< item 15
  double reference_innovation_m = 1.0;  ///< item 16
  int n_base = 1;                       ///< item 17
  int n_min = 2;                        ///< item 18
  int n_max = 40;                       ///< item 19
  int stuck_n = 32;                     ///< item 20
  double stuck_jump_scale = 0.6;        ///< item 21
  double stuck_weight_floor = 0.5;      ///< item 22
  double outlier_sigmas = 1.6;
};

/// Damping of a velocity that leads away from the fixes.
struct RunawaySettings {
  double position_error_m = 5.0;       ///< item 23
  double velocity_damp_max_hz = 10.0;  ///< item 24
};

/// Limits of the integrated acceleration.
struct MotionSettings {
  double accel_linear_threshold_mps2 = 30.0;  ///< item 25
  bool gyro_gate = true;                      ///< item 35
  double gyro_gate_projection_radps = 7.0;    ///< item 36
  double gyro_gate_freeze_radps = 8.0;        ///< item 37
};

/// Motion in a horizontal plane.
struct PlanarSettings {
  bool planar = false;
  HeightSource height_from = HeightSource::setting;
  double height_m = 0.0;
  double height_std_m = 0.02;
  double tilt_std_deg = 1.0;
  bool output_flat = false;
};

/// Calibration of the gyroscope at rest before the first pose.
struct StartupSettings {
  double calibration_s = 1.0;
  double still_gyro_std_radps = 0.03;
  double still_accel_std_mps2 = 0.3;
  double max_gyro_offset_radps = 0.06;
  double still_moved_m = 0.2;
};

/// Detection of a track whose coordinates only repeat.
struct FrozenSettings {
  double moved_m = 0.3;
  double window_s = 1.0;
  int repeats = 3;
};

/// Noise assumptions behind the reported standard deviations.
struct UncertaintySettings {
  double fix_std_m = 0.02;
  double heading_std_deg = 1.0;
  double accel_std_mps2 = 0.2;
  double yaw_drift_std_degps = 0.1;
};

/// Predicted poses between IMU samples.
struct OutputSettings {
  int rate_hz = 0;
};

struct Settings {
  EngineSettings engine;
  PresetSettings preset;
  DriftSettings drift;
  VelocitySettings velocity;
  AlignmentSettings alignment;
  HeadingSettings heading;
  DelaySettings delay;
  TwistSettings twist;
  OutageSettings outage;
  AdmissionSettings admission;
  TrustSettings trust;
  RunawaySettings runaway;
  MotionSettings motion;
  PlanarSettings planar;
  attitude::Settings attitude;
  StartupSettings startup;
  FrozenSettings frozen;
  UncertaintySettings uncertainty;
  OutputSettings output;
  calibration::Settings calibration;
};

}  // namespace sonopose::settings
