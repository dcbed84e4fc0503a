#pragma once
/// \file
/// Items 25 and 35–37: gates the acceleration and integrates it into velocity and position (equations 1 and 2
/// of the strapdown document).

#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::MotionSettings;

namespace motion {

/// Part of the acceleration that is integrated: all, the part along the velocity, or none (items 35–37).
[[nodiscard]] Vector3d gate(const MotionSettings& settings, const Kinematics& body,
                            const Vector3d& acceleration_world_mps2);

/// True if the gate reduces the acceleration at the current rate.
[[nodiscard]] bool is_gated(const MotionSettings& settings, const Kinematics& body);

/// Integrates velocity and position over `dt_s` at constant acceleration: p += v·dt + ½·a·dt², v += a·dt.
/// Applies the soft limiter of item 25 at the measured acceleration.
void integrate(const MotionSettings& settings, Kinematics& body, const Vector3d& acceleration_world_mps2,
               double dt_s);

/// Performs one step of stale mode: constant velocity, without acceleration.
void predict_without_imu(Kinematics& body, double dt_s);

}  // namespace motion
}  // namespace sonopose::estimation::documented
