#pragma once
/// \file
/// The state of the engine at one moment, computed from the events in the order of their measurement. It
/// depends on nothing else: events that arrive in another order give the same state.

#include <sonopose/estimation/aiding/default_position.hpp>
#include <sonopose/estimation/aiding/known_sensors.hpp>
#include <sonopose/estimation/kalman/fix_noise.hpp>
#include <sonopose/estimation/kalman/frozen_track.hpp>
#include <sonopose/estimation/kalman/heading_gate.hpp>
#include <sonopose/estimation/kalman/hypothesis_bank.hpp>
#include <sonopose/estimation/kalman/imu_fault_detector.hpp>
#include <sonopose/estimation/kalman/imu_steps.hpp>
#include <sonopose/estimation/kalman/measurements.hpp>
#include <sonopose/estimation/kalman/rest.hpp>
#include <sonopose/estimation/kalman/slow_error.hpp>
#include <sonopose/estimation/kalman/twist.hpp>
#include <sonopose/estimation/kalman/wrong_tracks.hpp>
#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::estimation::kalman {

inline constexpr int proven_fixes = 8;  ///< used fixes after which the first one is believed

// Standard deviations per axis before the first measurement.
inline constexpr double start_gyro_bias_std_radps = 0.02;
inline constexpr double start_accel_bias_std_mps2 = 0.1;
inline constexpr double start_lever_arm_std_m = 0.05;

enum class Phase : std::uint8_t {
  waiting,        ///< no fix yet
  searching_yaw,  ///< one hypothesis per direction, and one that follows the fixes alone
  tracking        ///< one hypothesis per trusting model of the IMU
};

constexpr std::array<std::string_view, 3> choices_of(Phase /*phase*/) {
  return {"waiting", "searching_yaw", "tracking"};
}

/// Latest IMU sample, and the steps that the filters have not yet applied.
struct ImuInput {
  TimeNs time_ns = 0;  ///< time of the sample; 0 before the first
  Vector3d rate_body_radps = Vector3d::Zero();
  Vector3d force_body_mps2 = Vector3d::Zero();
  Vector3d mean_force_body_mps2 = Vector3d::Zero();  ///< mean of the last seconds, turned with the body
  double nominal_imu_period_s = 0;                   ///< usual interval between samples; 0: unknown
  bool in_gap = false;                               ///< true if the sample ended a silence
  RepeatDetector repeats;                            ///< repeated samples, which are a silence too
  ShockDetector shocks;                              ///< shocks of the accelerometer
  ShockDetector turn_shocks;                         ///< shocks of the gyroscope
  SpikeFilter force_spikes;                          ///< wrong samples of the accelerometer
  SpikeFilter rate_spikes;                           ///< wrong samples of the gyroscope
  ClipDetector gyro_clip;                            ///< end of the gyroscope's range
  ImuPreintegrator pending_steps;  ///< steps not yet applied to the filters; none in a checkpoint

  bool operator==(const ImuInput&) const = default;
  [[nodiscard]] ImuMeasurement latest() const {
    return {.time_ns = time_ns, .rate_body_radps = rate_body_radps, .force_body_mps2 = force_body_mps2};
  }
};

/// A sample without readings that are held back, and the step to it.
struct AdmittedStep {
  ImuMeasurement sample;
  ImuStep step;
  SpikeFilter force_spikes;
  SpikeFilter rate_spikes;
  Vector3d dropped_impulse_body_mps =
      Vector3d::Zero();                               ///< integral of forces that were held back, and dropped
  Vector3d dropped_turn_body_rad = Vector3d::Zero();  ///< the same of rates
};

/// Heights that jumped away from the followed track, in a row.
struct HeightGate {
  static constexpr double named_after_s = 2.0;     ///< a shorter reflection is no fault
  static constexpr double believed_after_s = 8.0;  ///< heights that stay are right

  TimeNs jumped_ns = 0;    ///< time of the first; 0: none
  TimeNs left_out_ns = 0;  ///< time of the latest that was left out
  double first_m = 0;      ///< its innovation
  double predicted_m = 0;  ///< its prediction

  /// True while heights have been left out for so long that the status says so.
  [[nodiscard]] bool is_inconsistent(TimeNs time_ns) const {
    constexpr double current_s = 1.0;
    return jumped_ns != 0 && seconds_between(jumped_ns, left_out_ns) > named_after_s &&
           seconds_between(left_out_ns, time_ns) < current_s;
  }
  bool operator==(const HeightGate&) const = default;
};

/// Recent fixes, as judged by the followed track.
struct FixGate {
  TimeNs used_ns = 0;   ///< measurement time of the last fix used; 0: none
  int since_start = 0;  ///< number of fixes used, up to proven_fixes
  int rejected_in_row = 0;
  int misfits_in_row = 0;                        ///< fixes in a row that fit badly, used or not
  double first_rejected_m = 0;                   ///< innovation of the first fix rejected in the row
  double trust = 1;                              ///< share of recent fixes that were used
  double quality_percent = -1;                   ///< quality of the last fix used; negative: unknown
  Vector3d rejected_world_m = Vector3d::Zero();  ///< latest rejected fix
  TimeNs rejected_ns = 0;                        ///< time of that fix
  HeightGate height{};                           ///< heights that are left out
  Vector3d point_body_m = Vector3d::Zero();      ///< located point of the latest fix

  bool operator==(const FixGate&) const = default;
};

/// Contribution of what else may be true to the covariance of the best filter.
struct Spread {
  double yaw_rad2 = 0;
  Matrix3d position_m2 = Matrix3d::Zero();
  Matrix3d velocity_m2ps2 = Matrix3d::Zero();
};

struct State {
  Phase phase = Phase::waiting;
  ImuInput imu;
  TimeNs time_ns = 0;  ///< time of the filters after the pending steps: that of the latest sample, or of a
                       ///< later measurement in a silence of the IMU
  HypothesisBank bank;
  bool restart_pending = false;  ///< true if the next fix restarts the estimate
  TimeNs converging_until_ns = 0;
  TimeNs last_zero_velocity_ns = 0;  ///< time of the last used fix or zero-velocity update
  FixGate fixes;
  HeadingGate headings;
  MeasurementNoise noise;
  RestState rest;
  FrozenTrackDetector frozen_track;
  aiding::DefaultPosition default_position;
  WrongTracks wrong_tracks;
  SlowErrorDetector slow_error;
  ImuFaultDetector imu_fault;
  AtMostOne<TwistGate> twist;             ///< there once a velocity was measured
  AtMostOne<aiding::KnownSensors> known;  ///< errors of the sensors before the first sample, if known

  bool operator==(const State&) const = default;

  /// Best filter. Requires that the estimate has started.
  [[nodiscard]] const Filter& filter() const { return bank.best().filter; }

  /// True while yaw is searched, or IMU or fixes may be wrong: the best filter's covariance is too small
  /// then.
  [[nodiscard]] bool is_ambiguous() const;
  /// Mean square distance of the possible hypotheses from the best one, weighted by likelihood: the starts,
  /// or the distrustful models of the IMU. Includes a mean innovation that is not zero, slow errors of the
  /// fixes and an offset of the clocks. Requires `is_ambiguous()`.
  [[nodiscard]] Spread spread() const;

  ImuOutcome on_imu(const settings::Settings& settings, const ImuMeasurement& sample);
  FixOutcome on_fix(const settings::Settings& settings, const FixMeasurement& fix);
  HeadingOutcome on_heading(const settings::Settings& settings, const HeadingMeasurement& heading);
  void on_twist(const settings::Settings& settings, const TwistMeasurement& measured);

  /// Handles a change of the mount offset by this angle. If the yaw is known from headings, the angle adds to
  /// its uncertainty.
  void on_mount_offset_change(double by_rad);

  /// Nominal state of the best filter at the latest sample, after the pending steps; arbitrary while waiting.
  [[nodiscard]] NominalState nominal() const;
  /// Step from the latest sample to this one.
  [[nodiscard]] AdmittedStep step_to(const ImuMeasurement& sample) const;
  /// Nominal state after one more step.
  [[nodiscard]] NominalState nominal_after(const ImuStep& step) const;

  /// Applies the pending steps to all filters.
  void apply_pending_steps();
  /// Applies the pending steps and propagates the covariance of every filter to the time of the latest
  /// sample.
  void propagate();
  /// True if this sample is the latest one again and the body moves: no motion may be integrated from it.
  [[nodiscard]] bool is_repetition(const ImuMeasurement& sample) const;
  /// True if no fix or heading has required a propagation for a while.
  [[nodiscard]] bool covariance_is_old() const;
};

/// Adds the variance of the motion that an irregular step may miss.
void add_missed_motion(Filter& filter, const ImuStep& step);

/// Measurement of a calibrated sample.
[[nodiscard]] ImuMeasurement as_measurement(const ImuSample& calibrated);

void for_each_field(IsFieldsOf<ImuInput> auto& imu, const auto& visit) {
  visit("time_ns", imu.time_ns);
  visit("rate_body_radps", imu.rate_body_radps);
  visit("force_body_mps2", imu.force_body_mps2);
  visit("mean_force_body_mps2", imu.mean_force_body_mps2);
  visit("nominal_imu_period_s", imu.nominal_imu_period_s);
  visit("in_gap", imu.in_gap);
  visit("repeats", imu.repeats);
  visit("shocks", imu.shocks);
  visit("turn_shocks", imu.turn_shocks);
  visit("force_spikes", imu.force_spikes);
  visit("rate_spikes", imu.rate_spikes);
  visit("gyro_clip", imu.gyro_clip);
}

void for_each_field(IsFieldsOf<HeightGate> auto& height, const auto& visit) {
  visit("jumped_ns", height.jumped_ns);
  visit("left_out_ns", height.left_out_ns);
  visit("first_m", height.first_m);
  visit("predicted_m", height.predicted_m);
}

void for_each_field(IsFieldsOf<FixGate> auto& fixes, const auto& visit) {
  visit("used_ns", fixes.used_ns);
  visit("since_start", fixes.since_start);
  visit("rejected_in_row", fixes.rejected_in_row);
  visit("misfits_in_row", fixes.misfits_in_row);
  visit("first_rejected_m", fixes.first_rejected_m);
  visit("trust", fixes.trust);
  visit("quality_percent", fixes.quality_percent);
  visit("rejected_world_m", fixes.rejected_world_m);
  visit("rejected_ns", fixes.rejected_ns);
  visit("height", fixes.height);
  visit("point_body_m", fixes.point_body_m);
}

void for_each_field(IsFieldsOf<State> auto& state, const auto& visit) {
  visit("phase", state.phase);
  visit("imu", state.imu);
  visit("time_ns", state.time_ns);
  visit("bank", state.bank);
  visit("restart_pending", state.restart_pending);
  visit("converging_until_ns", state.converging_until_ns);
  visit("last_zero_velocity_ns", state.last_zero_velocity_ns);
  visit("fixes", state.fixes);
  visit("headings", state.headings);
  visit("noise", state.noise);
  visit("rest", state.rest);
  visit("frozen_track", state.frozen_track);
  visit("default_position", state.default_position);
  visit("wrong_tracks", state.wrong_tracks);
  visit("slow_error", state.slow_error);
  visit("imu_fault", state.imu_fault);
  visit("twist", state.twist);
  visit("known", state.known);
}

}  // namespace sonopose::estimation::kalman
