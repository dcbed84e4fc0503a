#pragma once
/// \file
/// Detection of faults of the IMU by fixes and headings.

#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/samples/field_fault.hpp>

namespace sonopose::estimation::kalman {

/// A track at a constant or evenly growing offset from the followed one. A wrong IMU leads a filter away ever
/// faster.
struct ShiftedTrack {
  TimeNs seen_ns = 0;
  Vector3d offset_world_m = Vector3d::Zero();
  Vector3d drift_world_mps = Vector3d::Zero();
  double variance_m2 = 0;  ///< per axis; 0: none yet
  double covariance_m2ps = 0;
  double drift_variance_m2ps2 = 0;

  double evidence = 0;  ///< evidence, as of a hypothesis

  /// Adds a fix at this offset. Returns its log-likelihood.
  double add(TimeNs time_ns, const Vector3d& offset_world_m, const Matrix3d& covariance_m2);
  bool operator==(const ShiftedTrack&) const = default;
};

/// Faults of the IMU, and what else explains badly fitting fixes: scatter or a shifted track.
struct ImuFaultDetector {
  ShiftedTrack shifted;
  TimeNs suspicious_until_ns =
      0;  ///< time until which badly fitting fixes or headings keep the distrustful models alive
  TimeNs faulty_until_ns = 0;  ///< time until which the IMU counts as wrong
  TimeNs detected_ns = 0;      ///< time when a distrustful model last became the best; 0: never
  int faults = 0;              ///< faults within the last minute
  Vector3d trusted_gyro_bias_body_radps = Vector3d::Zero();  ///< bias before the fault
  Vector3d trusted_accel_bias_body_mps2 = Vector3d::Zero();
  Vector3d mean_innovation_world_m = Vector3d::Zero();  ///< mean of about the last nine used innovations
  double mean_innovation_chi2 = 0;                      ///< its squared norm, 3 degrees of freedom
  bool is_undecided = false;  ///< true after several consecutive rejected fixes, until one fits well
  Vector3d scatter_m2 = Vector3d::Zero();  ///< mean square of the best innovations; zero: none yet

  /// Adds an innovation of the best hypothesis. Returns the log-likelihood of a fix that scatters about it as
  /// the last ones did.
  double add_scatter(const Innovation& innovation);
  /// Adds the innovation of a used fix to the mean. White innovations have a mean of zero.
  void add_used(const Innovation& innovation);
  /// Forgets the innovations, because another track or model is followed.
  void forget_innovations();
  bool operator==(const ImuFaultDetector&) const = default;
};

void for_each_field(IsFieldsOf<ShiftedTrack> auto& shifted, const auto& visit) {
  visit("seen_ns", shifted.seen_ns);
  visit("offset_world_m", shifted.offset_world_m);
  visit("drift_world_mps", shifted.drift_world_mps);
  visit("variance_m2", shifted.variance_m2);
  visit("covariance_m2ps", shifted.covariance_m2ps);
  visit("drift_variance_m2ps2", shifted.drift_variance_m2ps2);
  visit("evidence", shifted.evidence);
}

void for_each_field(IsFieldsOf<ImuFaultDetector> auto& detector, const auto& visit) {
  visit("shifted", detector.shifted);
  visit("suspicious_until_ns", detector.suspicious_until_ns);
  visit("faulty_until_ns", detector.faulty_until_ns);
  visit("detected_ns", detector.detected_ns);
  visit("faults", detector.faults);
  visit("trusted_gyro_bias_body_radps", detector.trusted_gyro_bias_body_radps);
  visit("trusted_accel_bias_body_mps2", detector.trusted_accel_bias_body_mps2);
  visit("mean_innovation_world_m", detector.mean_innovation_world_m);
  visit("mean_innovation_chi2", detector.mean_innovation_chi2);
  visit("is_undecided", detector.is_undecided);
  visit("scatter_m2", detector.scatter_m2);
}

}  // namespace sonopose::estimation::kalman
