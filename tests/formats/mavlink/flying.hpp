#pragma once
/// \file
/// A pose as an autopilot gets it, with other values in every field.

#include "autopilot/external_odometry.hpp"
#include <sonopose/geometry/rotation.hpp>

namespace flying {

using namespace sonopose;

/// Nose up by 0.2 rad, right side down by 0.1 rad, heading 0.3 rad right of north.
inline autopilot::ExternalOdometry odometry() {
  autopilot::ExternalOdometry odometry;
  odometry.is_ned = true;
  odometry.position_frame_m = {1, 2, -3};
  odometry.q_body_to_frame = geometry::rotation_of(geometry::EulerAngles<double>{0.1, 0.2, 0.3});
  odometry.velocity_body_mps = {4, 5, 6};
  odometry.angular_velocity_body_radps = {0.7, 0.8, 0.9};
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      odometry.pose_covariance(row, column) = 1 + std::min(row, column) * 10 + std::max(row, column);
    }
  }
  odometry.velocity_covariance_body << 0.1, 0.02, 0.03, 0.02, 0.2, 0.04, 0.03, 0.04, 0.3;
  return odometry;
}

constexpr TimeNs stamp_ns = 1'700'000'000'123'456'789;

}  // namespace flying
