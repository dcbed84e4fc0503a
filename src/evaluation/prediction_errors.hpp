#pragma once
/// \file
/// What a run predicted of each measurement before it arrived. It needs no truth, so it scores any recording.

#include "evaluation/score.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace sonopose::evaluation {

/// A measurement minus its prediction along one direction; NaN if there are none.
struct SignedErrors {
  double mean;
  double rms;
};

/// Squared normalised innovations of the fixes that were used, as the engine reported them. For an engine
/// whose covariances are right, the mean lies in the band for 19 of 20 runs.
struct NormalisedInnovations {
  std::size_t fixes = 0;
  double mean = 0;  ///< per degree of freedom; 1 is expected
  double low = 0;
  double high = 0;
};

/// Errors of one quantity that is predicted.
struct PredictedQuantity {
  std::size_t count = 0;
  SignedErrors error;
  double p95;      ///< of the absolute errors
  double lag_one;  ///< correlation of consecutive errors; near 0 if nothing is left to learn from them
};

/// Prediction errors of one run. The distances are those of all fixes; what follows them is of the fixes that
/// the engine used, because a wrong track of the beacons would hide what the settings do.
struct PredictionScore {
  std::size_t fixes = 0;          ///< with a pose at their emission
  std::size_t fixes_without = 0;  ///< without one
  ErrorSummary distance_m;        ///< fix to pose, 3D
  double distance_p50_m;
  double bounded_rms_m;  ///< an error counts as 0.3 m at most: a cost that wrong tracks do not decide
  SignedErrors along_m;  ///< positive: the fix is ahead of the pose; only where it moves horizontally
  SignedErrors left_m;   ///< positive: the fix is to the left of the pose, seen along its track
  SignedErrors up_m;     ///< positive: the fix is above the pose
  double lag_one;        ///< as of PredictedQuantity
  double gated_share;    ///< of the reported fixes
  std::optional<NormalisedInnovations> innovations;  ///< empty: the engine reports no covariance
  PredictedQuantity heading_rad;                     ///< of the pair, minus the mount offset and the yaw
  PredictedQuantity wheel_speed_mps;                 ///< its magnitude, minus that of the horizontal velocity
};

/// Compares each measurement with the poses that were published before it arrived, at the time at which it
/// was made. Takes everything in the order of arrival.
class PredictionErrors {
public:
  /// Measurements made before `from_ns` are not scored. `wheel_speeds`, in ascending time, must outlive this
  /// object.
  PredictionErrors(TimeNs from_ns, double mount_offset_rad,
                   std::span<const recording::WheelSpeed> wheel_speeds = {})
      : from_ns_(from_ns), mount_offset_rad_(mount_offset_rad), wheel_speeds_(wheel_speeds) {}

  void add(const FusedPose& pose);
  void add(const UltrasonicFix& fix);
  void add(const PairHeading& heading);
  /// Of the latest fix.
  void add(const FixReport& report);

  [[nodiscard]] PredictionScore score() const;

private:
  struct Predicted {
    TimeNs time_ns = 0;
    Vector3d position_world_m = Vector3d::Zero();
    Vector3d velocity_world_mps = Vector3d::Zero();
    Quaterniond q_body_to_world = Quaterniond::Identity();
  };

  struct FixError {
    TimeNs emission_time_ns = 0;
    Vector3d error_world_m = Vector3d::Zero();
    Vector3d velocity_world_mps = Vector3d::Zero();  ///< of the pose
    bool used = false;
  };

  [[nodiscard]] std::optional<Predicted> at(TimeNs time_ns) const;

  TimeNs from_ns_;
  double mount_offset_rad_;
  std::span<const recording::WheelSpeed> wheel_speeds_;  ///< those that are not compared yet
  std::deque<Predicted> poses_;                          ///< the latest seconds
  std::size_t without_ = 0;
  std::vector<FixError> fixes_;
  std::size_t reports_ = 0;
  std::size_t gated_ = 0;
  std::vector<double> squared_innovations_;
  std::vector<double> heading_rad_;
  std::vector<double> wheel_speed_mps_;
};

}  // namespace sonopose::evaluation
