#pragma once
/// \file
/// Errors of the fixes that last for seconds.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::kalman {

/// Power of the part of the innovations that is correlated over some fixes. A filter follows errors that vary
/// more slowly than its gain, and takes those of the fixes for white; a stiff one shows them in part.
struct SlowErrorDetector {
  TimeNs seen_ns = 0;                        ///< time of the latest fix
  Vector3d mean_world_m = Vector3d::Zero();  ///< mean of the innovations of late
  double mean_m2 = 0;                        ///< its variance if they are white, per axis
  double power_m2 = 0;  ///< mean product of an innovation with the mean before it, per axis; 0 if white
  double power_m4 = 0;  ///< its variance if they are white

  /// Adds the innovation of a used fix, and the covariances of both. The power stays unless the body `moves`:
  /// errors by place do not vary at rest.
  void add(TimeNs time_ns, const Vector3d& innovation_world_m,
           const Eigen::Matrix3d& innovation_covariance_m2, const Eigen::Matrix3d& fix_covariance_m2,
           bool moves);
  /// Variance of the slow error, per axis: what neither chance nor noise of the IMU with these densities
  /// explains.
  [[nodiscard]] double variance_m2(double accel_mps2_rthz, double gyro_radps_rthz) const;
  bool operator==(const SlowErrorDetector&) const = default;
};

void for_each_field(IsFieldsOf<SlowErrorDetector> auto& detector, const auto& visit) {
  visit("seen_ns", detector.seen_ns);
  visit("mean_world_m", detector.mean_world_m);
  visit("mean_m2", detector.mean_m2);
  visit("power_m2", detector.power_m2);
  visit("power_m4", detector.power_m4);
}

}  // namespace sonopose::estimation::kalman
