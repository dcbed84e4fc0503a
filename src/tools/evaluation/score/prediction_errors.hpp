#pragma once
/// \file
/// The prediction errors of a run: each measurement minus its prediction before it arrived. They need no
/// truth, so they score any recording.

#include "evaluation/score/score.hpp"
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

/// Squared normalised innovations. For an engine with correct covariances, the mean lies in the band for 19
/// of 20 runs.
struct NormalisedInnovations {
  std::size_t count = 0;
  double mean = 0;  ///< mean per degree of freedom; 1 is expected
  double low = 0;
  double high = 0;
};

/// Errors of one predicted quantity.
struct PredictedQuantity {
  std::size_t count = 0;
  SignedErrors error;
  double p50;      ///< median of the absolute errors
  double p95;      ///< 95th percentile of the absolute errors
  double lag_one;  ///< correlation of consecutive errors
};

struct FixError {
  TimeNs emission_time_ns = 0;
  Vector3d error_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();  ///< velocity of the pose
  bool trusted = false;                            ///< used by the engine, and not taken for an outlier
};

/// Prediction errors of one run. Distances include all fixes. The later values include only fixes that the
/// engine trusted, because a wrong track of the beacons would hide the effect of settings.
struct PredictionScore {
  std::vector<FixError> fixes;    ///< fixes with a pose at their emission
  std::size_t fixes_without = 0;  ///< number of fixes without a pose
  ErrorSummary distance_m;        ///< fix to pose, 3D
  double distance_p50_m;
  SignedErrors along_m;  ///< positive: the fix is ahead of the pose; only for horizontal motion
  SignedErrors left_m;   ///< positive: the fix is to the left of the pose, seen along its track
  SignedErrors up_m;     ///< positive: the fix is above the pose
  /// Correlation of consecutive innovations, as the engine reported them; near 0 if nothing is left to learn.
  double lag_one;
  double gated_share;  ///< outliers among the reported fixes
  /// Innovations of the fixes, as the engine reported them; empty if it reports no covariance.
  std::optional<NormalisedInnovations> innovations;
  PredictedQuantity heading_rad;  ///< heading minus that of the yaw, for a pair with the mount offset
  /// `heading_rad` of all headings, normalised by the variances of yaw and heading; empty if the engine
  /// estimates no noise of the headings.
  std::optional<NormalisedInnovations> heading_innovations;
  PredictedQuantity wheel_speed_mps;  ///< speed minus that of the horizontal velocity
};

/// Returns the RMS prediction error of the fixes that a run with other settings trusted, m. Settings cannot
/// reduce this cost by trusting a wrong track or by refusing good fixes. NaN if there are none.
double cost_of(const PredictionScore& score, const PredictionScore& reference);

/// Compares each measurement with the poses that were published before it arrived. The settings give its time
/// of measurement.
class PredictionErrors {
public:
  /// Ignores measurements made before `from_ns`. `wheel_speeds`, in ascending time, must outlive this object.
  PredictionErrors(TimeNs from_ns, const settings::Settings& settings,
                   std::span<const recording::WheelSpeed> wheel_speeds = {});

  /// Takes an event before the estimator does. `heading_noise_rad`: noise that the estimator expects of a
  /// heading.
  void add(const Event& event, const std::optional<ScalarEstimate>& heading_noise_rad = {});
  void add(const Event& event, const estimation::AnyEstimator& estimator);
  /// Takes the estimator's result for that event.
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
  std::span<const recording::WheelSpeed> wheel_speeds_;  ///< speeds that are not compared yet
  std::deque<Predicted> poses_;                          ///< poses of the latest seconds, in ascending time
  std::size_t without_ = 0;
  std::vector<FixError> fixes_;
  std::size_t reports_ = 0;
  std::size_t gated_ = 0;
  std::vector<Vector3d> innovations_world_m_;  ///< innovations of the trusted fixes
  std::vector<double> squared_innovations_;    ///< normalised innovations of the trusted fixes
  std::vector<double> heading_rad_;
  std::vector<double> squared_heading_innovations_;
  std::vector<double> wheel_speed_mps_;
};

}  // namespace sonopose::evaluation
