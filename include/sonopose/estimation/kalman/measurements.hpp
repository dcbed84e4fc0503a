#pragma once
/// \file
/// Fixes and headings at the time of their measurement, and the verdicts on them.

#include <sonopose/estimation/kalman/filter.hpp>

#include <cstdint>

namespace sonopose::estimation::kalman {

struct FixMeasurement {
  TimeNs time_ns = 0;
  TimeNs stamp_ns = 0;  ///< stamp of the source: equal in every copy of a fix, whenever it arrives
  Vector3d position_world_m = Vector3d::Zero();
  double quality_percent = -1;  ///< negative: unknown
  bool has_covariance = false;
  Matrix3d covariance_world_m2 =
      Matrix3d::Zero();  ///< covariance, if the source knows it; otherwise added to the learned one
  Vector3d point_body_m = Vector3d::Zero();  ///< located point, seen from the tracked one
  bool restarts = false;                     ///< the user's word: the estimate starts here

  bool operator==(const FixMeasurement&) const = default;
};

struct HeadingMeasurement {
  TimeNs time_ns = 0;
  TimeNs stamp_ns = 0;
  double heading_world_rad = 0;
  double std_rad = -1;    ///< negative: as learned
  bool restarts = false;  ///< the user's word, for the fix that follows

  bool operator==(const HeadingMeasurement&) const = default;
};

/// Verdict on a fix.
struct FixOutcome {
  Innovation innovation{};
  bool has_innovation = false;
  Matrix3d covariance_world_m2 =
      Matrix3d::Zero();   ///< covariance of the fix as used or rejected; zero: unknown
  double test_ratio = 0;  ///< squared norm over the rejection threshold
  double weight = 0;      ///< 1: full; 0: rejected
  // Changes by the fix, at its time:
  Vector3d jump_world_m = Vector3d::Zero();
  Vector3d velocity_change_world_mps = Vector3d::Zero();
  double yaw_change_rad = 0;
  std::uint32_t flags = 0;
  bool starts = false;           ///< true if the estimate started at it, false if it only changed track
  std::uint32_t hypothesis = 0;  ///< 1: the fix agreed with another track
};

/// Verdict on a heading.
struct HeadingOutcome {
  bool used = false;
  double variance_rad2 = 0;  ///< variance of the heading as used or rejected; 0: unknown
  double added_variance_rad2 =
      0;  ///< variance added to yaw before, if the heading was believed against the yaw
};

/// Conclusions from an IMU sample other than the motion.
struct ImuOutcome {
  bool still = false;  ///< true if it ends half a second of rest: rest.still_gyro_mean is the gyro bias
  double still_rate_variance = 0;  ///< variance of that bias, (rad/s)²
  double zero_velocity_variance =
      0;  ///< variance of zero velocity as a measurement, (m/s)²; 0: no such measurement
};

void for_each_field(IsFieldsOf<FixMeasurement> auto& fix, const auto& visit) {
  visit("time_ns", fix.time_ns);
  visit("stamp_ns", fix.stamp_ns);
  visit("position_world_m", fix.position_world_m);
  visit("quality_percent", fix.quality_percent);
  visit("has_covariance", fix.has_covariance);
  visit("covariance_world_m2", fix.covariance_world_m2);
  visit("point_body_m", fix.point_body_m);
  visit("restarts", fix.restarts);
}

void for_each_field(IsFieldsOf<HeadingMeasurement> auto& heading, const auto& visit) {
  visit("time_ns", heading.time_ns);
  visit("stamp_ns", heading.stamp_ns);
  visit("heading_world_rad", heading.heading_world_rad);
  visit("std_rad", heading.std_rad);
  visit("restarts", heading.restarts);
}

}  // namespace sonopose::estimation::kalman
