#pragma once
/// \file
/// Motions with exact derivatives.

#include "sim/jet.hpp"
#include <sonopose/samples/samples.hpp>

namespace sonopose::sim {

/// Whole state of a rigid body at one instant. The position is that of the tracked point: the beacon, or the
/// centre of the pair.
struct Motion {
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Vector3d acceleration_world_mps2 = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
  Vector3d angular_velocity_body_radps = Vector3d::Zero();
  Vector3d angular_acceleration_body_radps2 = Vector3d::Zero();
};

/// Position of the tracked point and attitude of the body: yaw about world Z, then pitch about the new Y,
/// then roll about the new X (ZYX Euler angles), in metres and radians.
struct Path {
  Jet x;
  Jet y;
  Jet z;
  Jet yaw;
  Jet pitch;
  Jet roll;
};

/// State of the body on a path, with the rates of the Euler angles converted to body rates and their
/// derivative.
Motion motion_on(const Path& path);

/// Distance covered at `per_second` after a rest until `start_s` and a smooth acceleration over `ramp_s`.
Jet smooth_departure(double time_s, double start_s, double ramp_s, double per_second);

/// Motion after turning the whole world by `yaw_rad` about the vertical through `pivot_world_m`, which does
/// not change the IMU's samples.
Motion turned(const Motion& motion, const Vector3d& pivot_world_m, double yaw_rad);

}  // namespace sonopose::sim
