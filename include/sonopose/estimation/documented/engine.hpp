#pragma once
/// \file
/// The estimator that the settings document describes, for one beacon.

#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/estimation/documented/state.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::estimation::documented {

/// Processes a beacon's events in the order of their arrival. It has no clock, allocates nothing and, once
/// made, never throws. Satisfies estimation::Estimator.
class Engine {
public:
  using Snapshot = documented::Snapshot;

  /// `settings` are the user's; the preset (item 1) is resolved here.
  explicit Engine(const settings::Settings& settings);

  /// Replaces the settings and keeps the state.
  void configure(const settings::Settings& settings) noexcept;

  /// Calibrates one raw IMU sample, integrates it and returns the pose at it. Returns nothing and counts the
  /// sample as invalid if it is not a possible measurement or precedes the previous one.
  std::optional<FusedPose> predict(const ImuSample& raw) noexcept;

  /// Corrects the state with one fix and reports what the fix changed.
  FixReport correct(const UltrasonicFix& fix) noexcept;

  /// Sets the yaw to which the following IMU samples turn the body.
  void correct(const PairHeading& heading) noexcept;
  void correct(const TwistSample& twist) noexcept;  ///< only counts it

  /// Adds the latest IMU sample to the history of the path, which a pose does not need.
  void finish_pending_work() noexcept;

  /// Discards the state. Counters are kept and reset_counter rises.
  void reset() noexcept;

  /// Continues from a snapshot of another engine.
  void restore(const Snapshot& snapshot) noexcept;
  [[nodiscard]] Snapshot snapshot() const;

  /// Effective settings, with the preset resolved.
  [[nodiscard]] const settings::Settings& settings() const { return settings_; }
  /// The state; its history of the path may lack the latest IMU sample (see `finish_pending_work`).
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] TimeNs time_ns() const { return state_.body.time_ns; }
  [[nodiscard]] Estimate estimate() const;
  [[nodiscard]] const EstimatorCounters& counters() const { return counters_; }
  [[nodiscard]] std::uint32_t reset_counter() const { return reset_counter_; }

private:
  void convert_gyro_offset(const calibration::Calibration& before);

  bool admit(const ImuSample& imu);
  void start(const ImuSample& imu);
  void calibrate_at_rest(const ImuSample& imu);
  void integrate(const ImuSample& imu, double dt_s);
  void integrate_attitude(const ImuSample& imu, double dt_s);
  void integrate_velocity(const ImuSample& imu, double dt_s);
  void predict_over_gap(const ImuSample& imu, double dt_s);
  [[nodiscard]] Vector3d world_acceleration(const ImuSample& imu) const;

  std::uint32_t reject(const UltrasonicFix& fix);
  void use_set_yaw(const UltrasonicFix& fix, bool fix_is_used);
  [[nodiscard]] UltrasonicFix of_tracked_point(const UltrasonicFix& fix) const;
  bool is_default_position(const UltrasonicFix& fix);
  void move_to(const TimedFix& fix, FixReport& report);
  void reset_position(const TimedFix& fix, FixReport& report);
  bool reset_velocity(TimedFix& fix, FixReport& report);
  void correct_pose(const TimedFix& fix, FixReport& report);
  void align(const TimedFix& fix, const FixVelocity& measured, const VelocityChange& change,
             FixReport& report);

  [[nodiscard]] FusedPose pose_at(const ImuSample& imu) const;
  [[nodiscard]] std::uint32_t status() const;
  [[nodiscard]] Vector3d gyro_bias_body_radps() const;

  settings::Settings settings_;
  calibration::Calibration calibration_;
  State state_;
  EstimatorCounters counters_;
  std::uint32_t reset_counter_ = 0;
  std::optional<PairHeading> set_yaw_;  ///< that of the user, until the fix that comes with it
  bool path_is_behind_ = false;
};

}  // namespace sonopose::estimation::documented
