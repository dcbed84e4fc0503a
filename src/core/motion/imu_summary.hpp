#pragma once
/// \file
/// A summary of an IMU's readings that shows wrong units and axes, at rest and in motion.

#include "motion/window.hpp"

#include <cstdint>
#include <span>

namespace sonopose::motion {

/// Unit of the specific force, judged by gravity.
enum class ForceUnit : std::uint8_t {
  mps2,
  g,
  mg,
  no_gravity,  ///< gravity seems to be removed
  unknown,
};

/// Statistics of finite readings in order of time, in body axes. All 0 without readings.
struct ImuSummary {
  double duration_s = 0;
  Vector3d mean_force_body_mps2 = Vector3d::Zero();
  double median_force_mps2 = 0;  ///< median of the magnitude
  double force_range_mps2 = 0;   ///< interquartile range of the magnitude
  double fast_rate_radps = 0;    ///< exceeded by every twentieth sample
  /// RMS deviation of the specific force from its mean over 4 s, turned by the rates to axes that do not turn
  /// with the body. With right rates it is the acceleration's.
  double turned_deviation_mps2 = 0;
  double unturned_deviation_mps2 = 0;  ///< the same without turning
};

ImuSummary summary_of(std::span<const Reading> imu);

/// The unit that makes the usual force that of a body which stands, drives or flies.
ForceUnit force_unit_of(const ImuSummary& imu);

/// True if the rates are more likely in deg/s than in rad/s: they are faster than a vehicle turns, or turn
/// gravity to where the accelerometer does not see it.
bool has_rates_in_degrees(const ImuSummary& imu);

/// True if rates in deg/s would be faster than any gyroscope's range: they are in mdeg/s.
bool has_rates_in_millidegrees(const ImuSummary& imu);

}  // namespace sonopose::motion
