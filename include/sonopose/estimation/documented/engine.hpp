#pragma once
/// \file
/// The documented fusion: one engine for one beacon. Events go in, in the order of their arrival; a pose
/// comes out at every IMU sample and a report at every fix. It knows no clock, allocates nothing and never
/// throws once made.

#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/estimation/documented/state.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::estimation::documented {

class Engine {
public:
  /// `settings` as the user gave them: the preset (item 1) is resolved here.
  explicit Engine(const settings::Settings& settings);

  /// Goes on with other settings, as the user gave them, and with all that it knows so far.
  void configure(const settings::Settings& settings) noexcept;

  /// One IMU sample as the sensor gave it, which is calibrated here: the pose at it. Empty where the sample
  /// is no measurement or lies before the last one, which is counted.
  std::optional<FusedPose> on(const ImuSample& raw) noexcept;

  /// One fix: what was done with it.
  FixReport on(const UltrasonicFix& fix) noexcept;

  /// One heading of the paired beacons.
  void on(const PairHeading& heading) noexcept;

  /// Begins anew, as at the start; counters go on and the pose's reset_counter rises.
  void reset() noexcept;

  /// Goes on from where another engine was.
  void restore(const Snapshot& snapshot) noexcept;
  [[nodiscard]] Snapshot snapshot() const { return {state_, counters_, reset_counter_}; }

  [[nodiscard]] const settings::Settings& settings() const { return settings_; }
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] std::uint32_t reset_counter() const { return reset_counter_; }

private:
  void translate_offset(const calibration::Calibration& before);
  void start(const ImuSample& imu);
  void calibrate(const ImuSample& imu);
  void predict(const ImuSample& imu, double dt_s);
  double predict_attitude(const ImuSample& imu, double dt_s);
  void predict_velocity(const ImuSample& imu, double dt_s);
  [[nodiscard]] Vector3d world_acceleration(const ImuSample& imu) const;
  void rest_over_gap(const ImuSample& imu, double dt_s);
  void remember_path();
  void reset_position(const TimedFix& fix, FixReport& report);
  bool reset_velocity(TimedFix& fix, FixReport& report);
  void apply_fix(const TimedFix& fix, FixReport& report);
  void align(const FixVelocity& measured, const VelocityChange& change, FixReport& report);
  [[nodiscard]] FusedPose pose_at(const ImuSample& imu) const;
  [[nodiscard]] std::uint32_t status() const;

  settings::Settings settings_;
  calibration::Calibration calibration_;
  State state_;
  Counters counters_;
  std::uint32_t reset_counter_ = 0;
};

/// Gives the engine any event; calls `on_pose(FusedPose&)` or `on_report(const FixReport&)` for what comes of
/// it.
template <class OnPose, class OnReport>
void deliver(Engine& engine, const Event& event, const OnPose& on_pose, const OnReport& on_report) {
  if (const auto* imu = std::get_if<ImuSample>(&event)) {
    if (auto pose = engine.on(*imu)) on_pose(*pose);
  } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
    on_report(engine.on(*fix));
  } else {
    engine.on(std::get<PairHeading>(event));
  }
}

}  // namespace sonopose::estimation::documented
