#pragma once
/// \file
/// The state of the engine at one moment, computed from the events in the order of their measurement. It
/// depends on nothing else, so that events that arrive in another order give the same state.

#include <sonopose/estimation/documented/default_position.hpp>
#include <sonopose/estimation/kalman/fix_noise.hpp>
#include <sonopose/estimation/kalman/frozen_track.hpp>
#include <sonopose/estimation/kalman/heading_gate.hpp>
#include <sonopose/estimation/kalman/hypothesis_bank.hpp>
#include <sonopose/estimation/kalman/imu_doubt.hpp>
#include <sonopose/estimation/kalman/imu_steps.hpp>
#include <sonopose/estimation/kalman/measurements.hpp>
#include <sonopose/estimation/kalman/rest.hpp>
#include <sonopose/estimation/kalman/wrong_tracks.hpp>
#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::estimation::kalman {

inline constexpr int proven_fixes = 8;  ///< used fixes after which the first one is believed

// Knowledge before the first measurement: standard deviations per axis.
inline constexpr double start_gyro_bias_std_radps = 0.02;
inline constexpr double start_accel_bias_std_mps2 = 0.1;
inline constexpr double start_lever_arm_std_m = 0.05;

enum class Phase : std::uint8_t {
  waiting,        ///< for the first fix
  searching_yaw,  ///< one hypothesis per direction, and one that follows the fixes alone
  tracking        ///< one hypothesis per closed model of the IMU
};

constexpr std::array<std::string_view, 3> choices_of(Phase /*phase*/) {
  return {"waiting", "searching_yaw", "tracking"};
}

/// The latest IMU sample, and what the filters have not yet applied.
struct ImuInput {
  TimeNs time_ns = 0;  ///< 0 before the first
  Vector3d rate_body_radps = Vector3d::Zero();
  Vector3d force_body_mps2 = Vector3d::Zero();
  Vector3d mean_force_body_mps2 = Vector3d::Zero();  ///< low-passed until the first fix
  double usual_step_s = 0;                           ///< between samples; 0: not known
  bool in_gap = false;                               ///< the sample ended a silence
  ShockDetector shocks;                              ///< of the accelerometer
  ShockDetector turn_shocks;                         ///< of the gyroscope
  JoinedSteps open_steps;                            ///< not yet applied to the filters; none in a checkpoint

  bool operator==(const ImuInput&) const = default;
};

/// The recent fixes as the followed track has judged them.
struct FixGate {
  TimeNs used_ns = 0;   ///< measurement of the last fix that was used; 0: none
  int since_start = 0;  ///< fixes that were used; up to proven_fixes
  int rejected_in_row = 0;
  double trust = 1;                              ///< share of recent fixes that were used
  double quality_percent = -1;                   ///< of the last fix that was used; negative: unknown
  Vector3d rejected_world_m = Vector3d::Zero();  ///< the latest fix that was rejected
  TimeNs rejected_ns = 0;                        ///< its time

  bool operator==(const FixGate&) const = default;
};

/// Share of the other directions of an unknown yaw in the covariance of the best filter.
struct Spread {
  double yaw_rad2 = 0;
  Matrix3d position_m2 = Matrix3d::Zero();
  Matrix3d velocity_m2ps2 = Matrix3d::Zero();
};

struct State {
  Phase phase = Phase::waiting;
  ImuInput imu;
  TimeNs time_ns = 0;  ///< of the filters after the open steps: that of the latest sample, or of a later
                       ///< measurement in a silence of the IMU
  HypothesisBank bank;
  bool restart_pending = false;  ///< the next fix starts the estimate again
  TimeNs converging_until_ns = 0;
  TimeNs slowed_ns = 0;  ///< last bound of dead reckoning
  FixGate fixes;
  HeadingGate headings;
  MeasurementNoise noise;
  RestState rest;
  FrozenTrackDetector frozen_track;
  documented::DefaultPosition default_position;
  WrongTracks wrong_tracks;
  ImuDoubt doubt;

  bool operator==(const State&) const = default;

  /// The best filter. Requires that the estimate has started.
  [[nodiscard]] const Filter& filter() const { return bank.best().filter; }

  /// The mean square of the distance of all starts from the best one, weighted by their likelihood; zero
  /// while tracking.
  [[nodiscard]] Spread spread() const;

  ImuOutcome on_imu(const settings::Settings& settings, const ImuMeasurement& sample);
  FixOutcome on_fix(const settings::Settings& settings, const FixMeasurement& fix);
  HeadingOutcome on_heading(const settings::Settings& settings, const HeadingMeasurement& heading);

  /// The mount offset was changed by this angle: if headings have held the yaw until now, it is as uncertain.
  void on_mount_offset_change(double by_rad);

  /// The nominal state of the best filter at the latest sample, after the open steps; while waiting, any.
  [[nodiscard]] NominalState nominal() const;
  /// The same after one more step.
  [[nodiscard]] NominalState nominal_after(const ImuStep& step) const;

  /// Applies the open steps to all filters.
  void close_steps();
  /// Applies the open steps, and propagates the covariance of every filter to the time of the latest sample.
  void propagate();
  /// True if no fix or heading has made that necessary for a while.
  [[nodiscard]] bool covariance_is_old() const;
};

/// Adds the variance of what an irregular step may miss.
void add_missed_motion(Filter& filter, const ImuStep& step);

/// The measurement of a calibrated sample.
[[nodiscard]] ImuMeasurement as_measurement(const ImuSample& calibrated);

void for_each_field(IsFieldsOf<ImuInput> auto& imu, const auto& visit) {
  visit("time_ns", imu.time_ns);
  visit("rate_body_radps", imu.rate_body_radps);
  visit("force_body_mps2", imu.force_body_mps2);
  visit("mean_force_body_mps2", imu.mean_force_body_mps2);
  visit("usual_step_s", imu.usual_step_s);
  visit("in_gap", imu.in_gap);
  visit("shocks", imu.shocks);
  visit("turn_shocks", imu.turn_shocks);
}

void for_each_field(IsFieldsOf<FixGate> auto& fixes, const auto& visit) {
  visit("used_ns", fixes.used_ns);
  visit("since_start", fixes.since_start);
  visit("rejected_in_row", fixes.rejected_in_row);
  visit("trust", fixes.trust);
  visit("quality_percent", fixes.quality_percent);
  visit("rejected_world_m", fixes.rejected_world_m);
  visit("rejected_ns", fixes.rejected_ns);
}

void for_each_field(IsFieldsOf<State> auto& state, const auto& visit) {
  visit("phase", state.phase);
  visit("imu", state.imu);
  visit("time_ns", state.time_ns);
  visit("bank", state.bank);
  visit("restart_pending", state.restart_pending);
  visit("converging_until_ns", state.converging_until_ns);
  visit("slowed_ns", state.slowed_ns);
  visit("fixes", state.fixes);
  visit("headings", state.headings);
  visit("noise", state.noise);
  visit("rest", state.rest);
  visit("frozen_track", state.frozen_track);
  visit("default_position", state.default_position);
  visit("wrong_tracks", state.wrong_tracks);
  visit("doubt", state.doubt);
}

}  // namespace sonopose::estimation::kalman
