#pragma once
/// \file
/// Numbers of a pose, a fix and the truth, in the order for the page (page_messages.hpp), without the time of
/// the row. NaN is unknown.

#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <limits>
#include <string_view>

namespace sonopose::web::live {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

inline constexpr std::array<std::string_view, 17> pose_columns{
    "x",   "y",   "z",   "roll", "pitch",   "yaw",   "vx",     "vy",       "vz",
    "cxx", "cxy", "cyy", "czz",  "yaw_std", "trust", "status", "since_fix"};

/// Row of a pose. The position is known from the first fix on.
inline std::array<double, pose_columns.size()> pose_row(const FusedPose& pose) {
  const bool has_position = (pose.status & status_initialising) == 0;
  const Vector3d position = has_position ? pose.position_world_m : Vector3d::Constant(unknown);
  const auto euler = geometry::euler_angles_of(pose.q_body_to_world);
  const Vector3d& velocity = pose.velocity_world_mps;
  const auto& covariance = pose.pose_covariance;
  const auto known = [&covariance](int row, int column) {
    return covariance.is_known(row) ? covariance.at(row, column) : unknown;
  };
  return {position.x(),          position.y(),      position.z(), euler.roll_rad,
          euler.pitch_rad,       euler.yaw_rad,     velocity.x(), velocity.y(),
          velocity.z(),          known(0, 0),       known(0, 1),  known(1, 1),
          known(2, 2),           yaw_std_rad(pose), pose.trust,   static_cast<double>(pose.status),
          pose.since_valid_fix_s};
}

/// Columns of a fix. The verdict is a FixVerdict.
inline constexpr std::array<std::string_view, 10> fix_columns{"x",  "y",     "z",      "ix",    "iy",
                                                              "iz", "ratio", "weight", "flags", "verdict"};

inline std::array<double, fix_columns.size()> fix_row(const FixReport& report) {
  const Vector3d& position = report.position_world_m;
  const Vector3d innovation =
      has_innovation(report) ? report.innovation_world_m : Vector3d::Constant(unknown);
  return {position.x(),
          position.y(),
          position.z(),
          innovation.x(),
          innovation.y(),
          innovation.z(),
          report.test_ratio.value_or(unknown),
          report.weight,
          static_cast<double>(report.flags),
          static_cast<double>(verdict_of(report))};
}

inline constexpr std::array<std::string_view, 4> truth_columns{"x", "y", "z", "yaw"};

inline std::array<double, truth_columns.size()> truth_row(const TruthSample& truth) {
  const Vector3d& position = truth.position_world_m;
  return {position.x(), position.y(), position.z(), geometry::yaw_of(truth.q_body_to_world)};
}

}  // namespace sonopose::web::live
