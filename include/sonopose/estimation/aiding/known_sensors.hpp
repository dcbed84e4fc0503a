#pragma once
/// \file
/// Errors of the sensors that an earlier run of an engine has estimated.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/pose.hpp>

#include <optional>

namespace sonopose::estimation::aiding {

/// Errors of a beacon's sensors at a start, with standard deviations that allow for the time since.
struct KnownSensors {
  VectorEstimate gyro_bias_body_radps;
  VectorEstimate accel_bias_body_mps2;
  VectorEstimate lever_arm_body_m;  ///< from the tracked point to the IMU
  double fix_std_m = 0;             ///< per horizontal axis

  bool operator==(const KnownSensors&) const = default;
};

void for_each_field(IsFieldsOf<KnownSensors> auto& known, const auto& visit) {
  visit("gyro_bias_body_radps", known.gyro_bias_body_radps.value);
  visit("gyro_bias_std_radps", known.gyro_bias_body_radps.std);
  visit("accel_bias_body_mps2", known.accel_bias_body_mps2.value);
  visit("accel_bias_std_mps2", known.accel_bias_body_mps2.std);
  visit("lever_arm_body_m", known.lever_arm_body_m.value);
  visit("lever_arm_std_m", known.lever_arm_body_m.std);
  visit("fix_std_m", known.fix_std_m);
}

/// Returns true if an estimate is good enough to be kept for a later run: it has all values of KnownSensors,
/// with small standard deviations.
[[nodiscard]] bool is_learned(const Estimate& estimate);

/// Returns true if real sensors may have these values, with positive deviations.
[[nodiscard]] bool is_plausible(const KnownSensors& known);

/// Returns what an estimate of this age still says. The biases change with the temperature, which is unknown:
/// their deviations grow for an hour. A negative age is that of a clock that was set back, and counts as an
/// hour. Empty after 30 days, for values that no real sensor has, and unless `is_learned`.
[[nodiscard]] std::optional<KnownSensors> known_after(const Estimate& learned, double age_s);

}  // namespace sonopose::estimation::aiding
