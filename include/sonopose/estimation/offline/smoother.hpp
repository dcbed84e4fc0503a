#pragma once
/// \file
/// The trajectory supported by all measurements of a recording, before and after each moment.

#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/estimation/offline/judgement.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <span>
#include <vector>

namespace sonopose::estimation::offline {

/// Noise with which a segment is smoothed.
struct Noise {
  kalman::ProcessNoise process;
  double fix_scale = 1;  ///< standard deviations of the fixes relative to those of the engine
};

/// Noise that makes the innovations of the fixes most likely, common to all segments: densities of
/// accelerometer and gyroscope, walk of the gyro bias, and scale of the fixes. It is fitted to the first
/// three minutes of the longest segment.
[[nodiscard]] Noise fitted_noise(const settings::Settings& settings, std::span<const Segment> segments);

/// Pose at one IMU sample, from all measurements.
struct SmoothedPose {
  TimeNs time_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();  ///< position of the tracked point
  Vector3d velocity_world_mps = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
  Vector3d gyro_bias_body_radps = Vector3d::Zero();
  Vector3d accel_bias_body_mps2 = Vector3d::Zero();
  Covariance<6> pose_covariance;  ///< m, rad: position in world, then a rotation about the fixed world axes
  Covariance<3> velocity_covariance;  ///< (m/s)², world
};

/// Poses at all IMU samples of a segment, in ascending time; empty if it has no sample or no used fix.
/// docs/smoother.md has the equations.
[[nodiscard]] std::vector<SmoothedPose> smoothed(const settings::Settings& settings, const Segment& segment,
                                                 const Noise& noise);

}  // namespace sonopose::estimation::offline
