#pragma once
/// \file
/// What a run predicted of each measurement before it arrived. It needs no truth, so it scores any recording.

#include "evaluation/score.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace sonopose::evaluation {

/// Measurements minus predictions along one direction; NaN if there are none.
struct SignedErrors {
  double mean;
  double rms;
};

/// Squared normalised innovations. For an engine whose covariances are right, the mean lies in the band for
/// 19 of 20 runs.
struct NormalisedInnovations {
  std::size_t count = 0;
  double mean = 0;  ///< per degree of freedom; 1 is expected
  double low = 0;
  double high = 0;
};

/// Errors of one quantity that is predicted.
struct PredictedQuantity {
  std::size_t count = 0;
  SignedErrors error;
  double p50;      ///< of the absolute errors
  double p95;      ///< the same
  double lag_one;  ///< correlation of consecutive errors
};

/// The prediction error of one fix.
struct FixError {
  TimeNs emission_time_ns = 0;
  Vector3d error_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();  ///< of the pose
  bool trusted = false;                            ///< the engine used it, and did not take it for an outlier
};

/// Prediction errors of one run. The distances are those of all fixes; what follows them is of the fixes that
/// the engine trusted, because a wrong track of the beacons would hide what the settings do.
struct PredictionScore {
  std::vector<FixError> fixes;    ///< with a pose at their emission
  std::size_t fixes_without = 0;  ///< without one
  ErrorSummary distance_m;        ///< fix to pose, 3D
  double distance_p50_m;
  SignedErrors along_m;  ///< positive: the fix is ahead of the pose; only where it moves horizontally
  SignedErrors left_m;   ///< positive: the fix is to the left of the pose, seen along its track
  SignedErrors up_m;     ///< positive: the fix is above the pose
  /// Correlation of consecutive innovations, as the engine reported them; near 0 if nothing is left to learn.
  double lag_one;
  double gated_share;  ///< outliers among the reported fixes
  /// Of the fixes, as the engine reported them; empty: it reports no covariance.
  std::optional<NormalisedInnovations> innovations;
  PredictedQuantity heading_rad;  ///< of the pair, minus the mount offset and the yaw
  /// Of all headings: `heading_rad` by the variances of yaw and heading; empty: the engine estimates no noise
  /// of the headings.
  std::optional<NormalisedInnovations> heading_innovations;
  PredictedQuantity wheel_speed_mps;  ///< its magnitude, minus that of the horizontal velocity
};

/// The RMS prediction error of the fixes that a run with other settings trusted, m: a cost that settings do
/// not reduce by trusting a wrong track or by refusing good fixes. NaN if there are none.
double cost_of(const PredictionScore& score, const PredictionScore& reference);

/// Compares each measurement with the poses that were published before it arrived, at the time at which it
/// was made by the settings.
class PredictionErrors {
public:
  /// Measurements made before `from_ns` are not scored. `wheel_speeds`, in ascending time, must outlive this
  /// object.
  PredictionErrors(TimeNs from_ns, const settings::Settings& settings,
                   std::span<const recording::WheelSpeed> wheel_speeds = {});

  /// Takes an event before the estimator does, a heading with the noise that the estimator expects of it.
  void add(const Event& event, const std::optional<ScalarEstimate>& heading_noise_rad = {});
  void add(const Event& event, const estimation::AnyEstimator& estimator);
  /// Takes what the estimator returned for it.
  void add(const estimation::EventResult& result);

  [[nodiscard]] PredictionScore score() const;

private:
  struct Predicted {
    TimeNs time_ns = 0;
    Vector3d position_world_m = Vector3d::Zero();
    Vector3d velocity_world_mps = Vector3d::Zero();
    Quaterniond q_body_to_world = Quaterniond::Identity();
    double yaw_std_rad = 0;  ///< NaN: unknown
  };

  void compare(const UltrasonicFix& fix);
  void compare(const PairHeading& heading, const std::optional<ScalarEstimate>& noise_rad);
  void compare_wheel_speeds(TimeNs until_ns);
  void keep(const FusedPose& pose);
  void keep(const FixReport& report);
  [[nodiscard]] std::optional<Predicted> at(TimeNs time_ns) const;

  TimeNs from_ns_;
  double mount_offset_rad_;
  settings::DelaySettings delay_;
  std::span<const recording::WheelSpeed> wheel_speeds_;  ///< those that are not compared yet
  std::deque<Predicted> poses_;                          ///< the latest seconds, in ascending time
  std::size_t without_ = 0;
  std::vector<FixError> fixes_;
  std::size_t reports_ = 0;
  std::size_t gated_ = 0;
  std::vector<Vector3d> innovations_world_m_;  ///< of the trusted fixes
  std::vector<double> squared_innovations_;    ///< the same, normalised
  std::vector<double> heading_rad_;
  std::vector<double> squared_heading_innovations_;
  std::vector<double> wheel_speed_mps_;
};

}  // namespace sonopose::evaluation
