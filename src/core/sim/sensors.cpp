#include "sim/sensors.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sonopose::sim {

namespace {

// Resolution of the beacon's IMU packet (marvelmind/conversions.hpp).
constexpr double accel_mps2_per_lsb = 1e-3 * standard_gravity_mps2;
constexpr double gyro_radps_per_lsb = 0.0175 * std::numbers::pi / 180;

/// Rounds to the packet's steps and clips to its 16 bits.
Vector3d quantised(const Vector3d& value, double step) {
  return value.unaryExpr(
      [step](double x) { return step * std::clamp(std::round(x / step), -32768.0, 32767.0); });
}

void require(bool good, const char* field, double value) {
  if (!good) {
    throw std::invalid_argument("simulated sensors: " + std::string(field) + " cannot be " +
                                std::to_string(value));
  }
}

}  // namespace

SensorSettings SensorSettings::ideal() {
  SensorSettings settings;
  settings.accel_noise_mps2 = 0;
  settings.gyro_noise_radps = 0;
  settings.accel_bias_mps2 = 0;
  settings.gyro_bias_radps = 0;
  settings.accel_bias_walk_mps2_rts = 0;
  settings.gyro_bias_walk_radps_rts = 0;
  settings.imu_quantised = false;
  settings.fix_rate_hz = 12.0;
  settings.fix_noise_m = 0.0;
  settings.fix_delay_jitter_s = 0;
  settings.quality_noise_percent = 0;
  settings.heading_noise_rad = 0;
  return settings;
}

void check(const SensorSettings& settings) {
  const auto not_negative = [](double value, const char* field) {
    require(std::isfinite(value) && value >= 0, field, value);
  };
  const auto range = [not_negative](const Range& values, const char* field) {
    not_negative(values.min, field);
    require(std::isfinite(values.max) && values.max >= values.min, field, values.max);
  };
  require(std::isfinite(settings.imu_rate_hz) && settings.imu_rate_hz > 0, "imu_rate_hz",
          settings.imu_rate_hz);
  not_negative(settings.accel_noise_mps2, "accel_noise_mps2");
  not_negative(settings.gyro_noise_radps, "gyro_noise_radps");
  not_negative(settings.accel_bias_mps2, "accel_bias_mps2");
  not_negative(settings.gyro_bias_radps, "gyro_bias_radps");
  not_negative(settings.accel_bias_walk_mps2_rts, "accel_bias_walk_mps2_rts");
  not_negative(settings.gyro_bias_walk_radps_rts, "gyro_bias_walk_radps_rts");
  for (const double error : settings.gyro_scale_error) {
    require(std::isfinite(error), "gyro_scale_error", error);
  }
  not_negative(settings.accel_limit_mps2, "accel_limit_mps2");
  not_negative(settings.gyro_limit_radps, "gyro_limit_radps");
  not_negative(settings.fix_resolution_m, "fix_resolution_m");
  for (const double factor : settings.fix_noise_factor) not_negative(factor, "fix_noise_factor");
  range(settings.fix_rate_hz, "fix_rate_hz");
  range(settings.fix_noise_m, "fix_noise_m");
  not_negative(settings.fix_delay_s, "fix_delay_s");
  not_negative(settings.fix_delay_jitter_s, "fix_delay_jitter_s");
  require(std::isfinite(settings.reported_delay_error_s), "reported_delay_error_s",
          settings.reported_delay_error_s);
  not_negative(settings.quality_percent, "quality_percent");
  not_negative(settings.quality_noise_percent, "quality_noise_percent");
  not_negative(settings.heading_noise_rad, "heading_noise_rad");
  not_negative(settings.wheel_rate_hz, "wheel_rate_hz");
  not_negative(settings.wheel_noise_mps, "wheel_noise_mps");
  not_negative(settings.wheel_wander, "wheel_wander");
  not_negative(settings.wheel_delay_s, "wheel_delay_s");
  require(std::isfinite(settings.wheel_scale_error), "wheel_scale_error", settings.wheel_scale_error);
}

ImuSample ideal_imu_sample(const Motion& motion, const Vector3d& lever_body_m) {
  const Vector3d& rate = motion.angular_velocity_body_radps;
  const Vector3d gravity_world_mps2{0.0, 0.0, -standard_gravity_mps2};
  const Vector3d tracked_point_body_mps2 =
      motion.q_body_to_world.conjugate() * (motion.acceleration_world_mps2 - gravity_world_mps2).eval();
  ImuSample sample;
  sample.meaning = ImuMeaning::instant;
  sample.angular_velocity_body_radps = rate;
  // Euler and centripetal acceleration of the lever arm on a rigid body.
  sample.specific_force_body_mps2 = tracked_point_body_mps2 +
                                    motion.angular_acceleration_body_radps2.cross(lever_body_m) +
                                    rate.cross(rate.cross(lever_body_m));
  return sample;
}

ImuModel::ImuModel(const SensorSettings& settings, const Random& random)
    : settings_{settings},
      random_{random},
      accel_bias_mps2_{settings.accel_bias_mps2 * random_.normal_vector()},
      gyro_bias_radps_{settings.gyro_bias_radps * random_.normal_vector()} {}

ImuSample ImuModel::measure(const Motion& motion, const Vector3d& gyro_drift_body_radps,
                            const std::function<void(ImuSample&)>& faults) {
  ImuSample sample = ideal_imu_sample(motion, settings_.imu_from_tracked_point_body_m);
  sample.specific_force_body_mps2 += accel_bias_mps2_ + settings_.accel_noise_mps2 * random_.normal_vector();
  sample.angular_velocity_body_radps +=
      settings_.gyro_scale_error.cwiseProduct(motion.angular_velocity_body_radps);
  sample.angular_velocity_body_radps +=
      gyro_bias_radps_ + gyro_drift_body_radps + settings_.gyro_noise_radps * random_.normal_vector();
  if (faults) faults(sample);
  const auto limited = [](const Vector3d& value, double limit) {
    return value.cwiseMax(-limit).cwiseMin(limit).eval();
  };
  sample.specific_force_body_mps2 = limited(sample.specific_force_body_mps2, settings_.accel_limit_mps2);
  sample.angular_velocity_body_radps =
      limited(sample.angular_velocity_body_radps, settings_.gyro_limit_radps);
  if (settings_.imu_quantised) {
    sample.specific_force_body_mps2 = quantised(sample.specific_force_body_mps2, accel_mps2_per_lsb);
    sample.angular_velocity_body_radps = quantised(sample.angular_velocity_body_radps, gyro_radps_per_lsb);
  }
  const double root_of_period = std::sqrt(1.0 / settings_.imu_rate_hz);
  accel_bias_mps2_ += settings_.accel_bias_walk_mps2_rts * root_of_period * random_.normal_vector();
  gyro_bias_radps_ += settings_.gyro_bias_walk_radps_rts * root_of_period * random_.normal_vector();
  return sample;
}

UltrasonicModel::UltrasonicModel(const SensorSettings& settings, Random random)
    : settings_{settings},
      random_{random},
      fix_rate_hz_{random_.uniform_in(settings.fix_rate_hz)},
      fix_noise_m_{random_.uniform_in(settings.fix_noise_m)} {}

double UltrasonicModel::next_delay_s() {
  constexpr double min_delay_s = 1e-3;
  return std::max(min_delay_s, settings_.fix_delay_s + settings_.fix_delay_jitter_s * random_.normal());
}

UltrasonicFix UltrasonicModel::measure_fix(const Motion& motion, const FixCondition& condition) {
  UltrasonicFix fix;
  const double noise_m = condition.noise_factor * fix_noise_m_;
  fix.position_world_m =
      motion.position_world_m + noise_m * settings_.fix_noise_factor.cwiseProduct(random_.normal_vector());
  if (const double step_m = settings_.fix_resolution_m; step_m > 0.0) {
    fix.position_world_m = step_m * (fix.position_world_m / step_m).array().round();
  }
  const double quality = condition.quality_percent
                             ? random_.uniform_in(*condition.quality_percent)
                             : settings_.quality_percent + settings_.quality_noise_percent * random_.normal();
  fix.quality_percent = std::clamp(std::round(quality), 0.0, 100.0);  // as in packet 0x0007: whole percent
  if (settings_.pair_heading) fix.flags |= ultrasonic_flag_pair_centre;
  return fix;
}

TwistSample WheelModel::measure(const Motion& motion, double slip) {
  constexpr double wander_s = 1.0;
  const double kept = std::exp(-1.0 / (settings_.wheel_rate_hz * wander_s));
  wander_ = kept * wander_ + std::sqrt(1.0 - kept * kept) * settings_.wheel_wander * random_.normal();
  const Vector3d velocity_body_mps = motion.q_body_to_world.conjugate() * motion.velocity_world_mps;
  TwistSample twist;
  twist.velocity_body_mps.x() = (1.0 + settings_.wheel_scale_error + wander_ + slip) * velocity_body_mps.x() +
                                settings_.wheel_noise_mps * random_.normal();
  twist.velocity_std_mps.x() = settings_.wheel_noise_mps;
  twist.axes = twist_velocity_x;
  return twist;
}

PairHeading UltrasonicModel::measure_heading(const Motion& motion, double error_rad) {
  PairHeading heading;
  const Quaterniond q_axis_to_world =
      motion.q_body_to_world * geometry::rotation_about_z(settings_.pair_mount_offset_rad);
  heading.heading_world_rad = geometry::wrap_angle(
      geometry::yaw_of(q_axis_to_world) + settings_.heading_noise_rad * random_.normal() + error_rad);
  heading.valid = true;
  return heading;
}

}  // namespace sonopose::sim
