#pragma once
/// \file
/// Errors of poses against the truth. Not aligned, because poses must be correct in the beacons' map.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sonopose::evaluation {

/// Root mean square, 95th percentile and maximum of errors; NaN if there are none.
struct ErrorSummary {
  double rmse;
  double p95;
  double max;
};

/// Summarises errors, in any order.
ErrorSummary error_summary_of(std::vector<double> errors);

/// Error of one orientation, d = q_estimate ⊗ q_truth*.
struct AttitudeError {
  double total_rad;        ///< 2·acos |d_w|: rotation angle of d
  double heading_rad;      ///< 2·atan |d_z/d_w|: rotation about world Z
  double inclination_rad;  ///< 2·acos √(d_w² + d_z²): angle between the verticals
};

AttitudeError error_of(const Quaterniond& q_estimate, const Quaterniond& q_truth);

/// Interpolates the truth at times in any order; consecutive nearby times are fast.
class TruthTrack {
public:
  /// `truth` is in ascending time and must outlive the track.
  explicit TruthTrack(std::span<const TruthSample> truth) : truth_(truth) {}

  /// Interpolates position and velocity linearly, attitude by slerp; NaN for unknown values. Empty before the
  /// first sample, after the last, and in gaps longer than 0.1 s.
  std::optional<TruthSample> at(TimeNs time_ns);

  /// Returns `at(time_ns)`; where the truth is sparse, its last sample after `before_ns` and up to `time_ns`,
  /// if the two are at most 0.1 s apart.
  std::optional<TruthSample> at_or_since(TimeNs before_ns, TimeNs time_ns);

private:
  std::span<const TruthSample> truth_;
  std::size_t next_ = 0;
};

/// Errors over one time span. Each includes the poses with known truth of that kind.
struct Score {
  std::size_t poses = 0;                ///< poses with a known true position
  std::size_t poses_without_truth = 0;  ///< poses in the span without a known true position
  ErrorSummary position_m;              ///< 3D distance
  double yaw_rmse_deg;                  ///< RMS of AttitudeError::heading_rad
  double tilt_rmse_deg;                 ///< RMS of AttitudeError::inclination_rad
  double velocity_rmse_mps;             ///< RMS length of the difference
  std::vector<double> errors_m;         ///< distance at each of `times_ns`
  std::vector<TimeNs> times_ns;
};

/// The pose at a time between two others.
FusedPose between(const FusedPose& before, const FusedPose& after, TimeNs time_ns);

/// Collects the errors of poses, in order of time. Sparse truth is compared with the pose interpolated to its
/// stamp.
class Scorer {
public:
  /// Ignores poses before `from_ns`. `truth` must outlive the scorer.
  Scorer(std::span<const TruthSample> truth, TimeNs from_ns) : track_(truth), from_ns_(from_ns) {}

  void add(const FusedPose& pose);

  [[nodiscard]] Score score() const;

private:
  void add(const FusedPose& pose, const TruthSample& truth);

  TruthTrack track_;
  TimeNs from_ns_;
  FusedPose before_{};
  std::size_t without_truth_ = 0;
  std::vector<TimeNs> times_ns_;
  std::vector<double> position_m_;
  std::vector<double> yaw_rad_;
  std::vector<double> tilt_rad_;
  std::vector<double> velocity_mps_;
};

}  // namespace sonopose::evaluation
