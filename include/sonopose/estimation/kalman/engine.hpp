#pragma once
/// \file
/// The error-state Kalman filter of one beacon.

#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/kalman/delayed_fusion_buffer.hpp>
#include <sonopose/samples/estimator_counters.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::estimation::kalman {

/// Everything in an engine except its settings.
struct Snapshot {
  History history;
  aiding::AdmissionState admission;
  TimeNs last_used_received_ns = 0;                   ///< receipt time of the last fix used; 0: none
  double last_delay_s = 0;                            ///< delay of that fix, from its stamp to its receipt
  Vector3d last_position_world_m = Vector3d::Zero();  ///< position of the latest pose
  EstimatorCounters counters;
  std::uint32_t reset_counter = 0;

  bool operator==(const Snapshot&) const = default;
};

/// Takes events in the order of their arrival and uses them in the order of their measurement. Satisfies
/// estimation::Estimator.
///
/// A sample that follows all other events only computes the nominal state of the best filter, which gives the
/// pose. Everything else follows in `finish_pending_work`. The covariances of a pose, and the status bits
/// that depend on them, are therefore one sample old, or as old as the last joined step of a fast IMU.
class Engine {
public:
  using Snapshot = kalman::Snapshot;

  explicit Engine(const settings::Settings& settings);

  /// Begins with known errors of the sensors. Call it before the first event; a reset forgets them.
  void start_from(const aiding::KnownSensors& known) noexcept { buffer_.start_from(known); }

  void configure(const settings::Settings& settings) noexcept;
  std::optional<FusedPose> predict(const ImuSample& raw) noexcept;
  FixReport correct(const UltrasonicFix& fix) noexcept;
  void correct(const PairHeading& heading) noexcept;
  void correct(const TwistSample& twist) noexcept;
  void finish_pending_work() noexcept;
  void reset() noexcept;
  void restore(const Snapshot& snapshot) noexcept;
  [[nodiscard]] Snapshot snapshot() const;

  /// Measurement of a sample: calibrated, or dated to its emission. Without delay compensation (item 6) a fix
  /// or heading counts as current.
  [[nodiscard]] ImuMeasurement measurement_in(const ImuSample& raw) const;
  [[nodiscard]] FixMeasurement measurement_in(const UltrasonicFix& fix) const;
  [[nodiscard]] HeadingMeasurement measurement_in(const PairHeading& heading) const;
  [[nodiscard]] TwistMeasurement measurement_in(const TwistSample& twist) const;

  [[nodiscard]] const settings::Settings& settings() const { return settings_; }
  /// State after the processed events (DelayedFusionBuffer::now).
  [[nodiscard]] const State& state() const { return buffer_.now(); }
  [[nodiscard]] TimeNs time_ns() const { return buffer_.time_ns(); }
  [[nodiscard]] Estimate estimate() const;
  [[nodiscard]] const EstimatorCounters& counters() const { return counters_; }
  [[nodiscard]] std::uint32_t reset_counter() const { return reset_counter_; }

private:
  bool admit(const ImuSample& imu);
  void count_dropped(bool last_twist_was_rejected);
  template <class Sample>
  [[nodiscard]] TimeNs measured_at(const Sample& sample) const;
  [[nodiscard]] std::uint32_t rejection_flags(const UltrasonicFix& fix, const FixMeasurement& measured) const;
  [[nodiscard]] bool is_step(const ImuMeasurement& imu) const;
  [[nodiscard]] FusedPose pose_after_step(const ImuSample& imu, const ImuMeasurement& measured) const;
  FusedPose whole_pose(const ImuSample& imu);
  void use_set_yaw(const FixMeasurement& fix, bool fix_is_used);
  [[nodiscard]] FusedPose pose_at(const ImuSample& imu, const Vector3d& rate_body_radps,
                                  const NominalState& nominal) const;
  void update_uncertainty();
  [[nodiscard]] std::uint32_t status(TimeNs time_ns) const;

  settings::Settings settings_;
  calibration::Calibration calibration_;
  DelayedFusionBuffer buffer_;
  /// Covariances and the status bits that depend on them, as of the last finish_pending_work().
  struct Uncertainty {
    Covariance<6> pose_covariance;
    Covariance<3> velocity_covariance;
    bool gyro_bias_is_unknown = false;
    bool clocks_differ = false;
    bool accel_bias_is_large = false;
    bool yaw_is_unknown = false;
  };
  Uncertainty uncertainty_;
  aiding::AdmissionState admission_;
  std::optional<HeadingMeasurement> set_yaw_;  ///< that of the user, until the fix that comes with it
  TimeNs last_used_received_ns_ = 0;
  double last_delay_s_ = 0;
  Vector3d last_position_world_m_ = Vector3d::Zero();
  EstimatorCounters counters_;
  std::uint32_t reset_counter_ = 0;
};

}  // namespace sonopose::estimation::kalman
