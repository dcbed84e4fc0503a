#include <sonopose/estimation/aiding/known_sensors.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::aiding {
namespace {

// Largest deviations of a learned value, and largest values of a usable sensor.
constexpr double max_gyro_bias_std_radps = 0.004;
constexpr double max_accel_bias_std_mps2 = 0.06;
constexpr double max_gyro_bias_radps = 0.35;
constexpr double max_accel_bias_mps2 = 1.0;
constexpr double max_lever_arm_m = 10.0;
constexpr double min_fix_std_m = 0.003;
constexpr double max_fix_std_m = 0.5;

/// True if the value and its deviation are finite and at most this large.
bool is_within(const VectorEstimate& estimate, double max_value, double max_std) {
  return estimate.value.allFinite() && estimate.std.allFinite() && estimate.std.minCoeff() >= 0.0 &&
         estimate.std.maxCoeff() <= max_std && estimate.value.cwiseAbs().maxCoeff() <= max_value;
}

VectorEstimate less_certain(const VectorEstimate& learned, double more_std) {
  const Vector3d variance = learned.std.array().square() + more_std * more_std;
  return {.value = learned.value, .std = variance.cwiseSqrt()};
}

}  // namespace

bool is_plausible(const KnownSensors& known) {
  constexpr double any_std = 1.0;
  return is_within(known.gyro_bias_body_radps, max_gyro_bias_radps, any_std) &&
         is_within(known.accel_bias_body_mps2, max_accel_bias_mps2, any_std) &&
         is_within(known.lever_arm_body_m, max_lever_arm_m, any_std) && known.fix_std_m >= min_fix_std_m &&
         known.fix_std_m <= max_fix_std_m;
}

bool is_learned(const Estimate& estimate) {
  if (!estimate.gyro_bias_body_radps || !estimate.accelerometer_bias_body_mps2 ||
      !estimate.lever_arm_body_m || !estimate.fix_noise_m)
    return false;
  return estimate.gyro_bias_body_radps->std.maxCoeff() <= max_gyro_bias_std_radps &&
         estimate.accelerometer_bias_body_mps2->std.maxCoeff() <= max_accel_bias_std_mps2 &&
         is_plausible({.gyro_bias_body_radps = *estimate.gyro_bias_body_radps,
                       .accel_bias_body_mps2 = *estimate.accelerometer_bias_body_mps2,
                       .lever_arm_body_m = *estimate.lever_arm_body_m,
                       .fix_std_m = estimate.fix_noise_m->value});
}

std::optional<KnownSensors> known_after(const Estimate& learned, double age_s) {
  constexpr double max_age_s = 30.0 * 24.0 * 3600.0;
  constexpr double warming_s = 3600.0;
  // Deviations of a MEMS sensor that is switched on again, warm and at another temperature.
  constexpr double warm_gyro_radps = 0.001;
  constexpr double cold_gyro_radps = 0.005;
  constexpr double warm_accel_mps2 = 0.01;
  constexpr double cold_accel_mps2 = 0.05;
  constexpr double moved_tag_m = 0.01;
  if (!(age_s <= max_age_s) || !is_learned(learned)) return std::nullopt;
  const double cooled = age_s < 0.0 ? 1.0 : std::min(1.0, age_s / warming_s);
  return KnownSensors{
      .gyro_bias_body_radps =
          less_certain(*learned.gyro_bias_body_radps, std::lerp(warm_gyro_radps, cold_gyro_radps, cooled)),
      .accel_bias_body_mps2 = less_certain(*learned.accelerometer_bias_body_mps2,
                                           std::lerp(warm_accel_mps2, cold_accel_mps2, cooled)),
      .lever_arm_body_m = less_certain(*learned.lever_arm_body_m, moved_tag_m),
      .fix_std_m = learned.fix_noise_m->value};
}

}  // namespace sonopose::estimation::aiding
