#pragma once
/// \file
/// Sensor models of the beacon: an IMU with bias, noise and quantisation, and ultrasonic fixes and pair
/// headings with noise and delay.

#include "sim/random.hpp"
#include "sim/trajectory.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/samples.hpp>

#include <functional>
#include <optional>
#include <utility>

namespace sonopose::sim {

/// Parameters of the sensors. Noises are standard deviations; 0 disables one. A value from a range is drawn
/// once per run.
struct SensorSettings {
  double imu_rate_hz = 100.0;
  double accel_noise_mps2 = 0.02;            ///< per sample and axis
  double gyro_noise_radps = 0.002;           ///< per sample and axis
  double accel_bias_mps2 = 0.03;             ///< spread of the constant bias over the seeds, per axis
  double gyro_bias_radps = 0.01;             ///< spread of the constant bias over the seeds, per axis
  double accel_bias_walk_mps2_rts = 0.0005;  ///< growth of the bias, per √s
  double gyro_bias_walk_radps_rts = 0.0001;  ///< growth of the bias, per √s
  Vector3d gyro_scale_error =
      Vector3d::Zero();  ///< scale error: the gyroscope reads 1 + this times the rate, per axis
  double accel_limit_mps2 = 16.0 * standard_gravity_mps2;  ///< limit of a reading, per axis
  double gyro_limit_radps = 35.0;                          ///< limit of a reading, per axis: 2000 °/s
  bool imu_quantised = true;  ///< 1 mg and 0.0175 deg/s in 16 bits, as the beacon sends it
  Vector3d imu_from_tracked_point_body_m = Vector3d::Zero();  ///< lever arm of the IMU

  Range fix_rate_hz{8.0, 16.0};                  ///< 0: no fixes and no headings
  Range fix_noise_m{0.015, 0.025};               ///< per axis
  Vector3d fix_noise_factor = Vector3d::Ones();  ///< factor of each axis, in units of `fix_noise_m`
  double fix_resolution_m = 0.0;                 ///< resolution of the coordinates; 0: not rounded
  double fix_delay_s = 0.068;
  double fix_delay_jitter_s = 0.003;
  double reported_delay_error_s = 0.0;  ///< reported delay minus the true one
  double quality_percent = 90.0;
  double quality_noise_percent = 3.0;

  double wheel_rate_hz = 0.0;      ///< rate of the speed of the wheels, along body X; 0: no wheels
  double wheel_noise_mps = 0.03;   ///< per sample
  double wheel_wander = 0.01;      ///< deviation of the scale error about its mean, over about a second
  double wheel_scale_error = 0.0;  ///< wheels read 1 + this times the speed
  double wheel_delay_s = 0.01;     ///< from measurement to receipt

  bool pair_heading = true;  ///< false: a single beacon, no headings
  double heading_noise_rad = 0.8 * geometry::radians_per_degree;
  double pair_mount_offset_rad = 0.0;  ///< direction of the pair's axis in the body, from body X to the left

  /// Ideal sensors: no noise, bias, jitter or quantisation; 12 fixes per second, delay as above.
  static SensorSettings ideal();
};

/// Throws std::invalid_argument, naming the invalid field.
void check(const SensorSettings& settings);

/// IMU of one beacon, with its bias.
class ImuModel {
public:
  ImuModel(const SensorSettings& settings, const Random& random);

  /// Measures the next sample of this motion; the caller sets stamps, address and number.
  /// `gyro_drift_body_radps` is added to the sensor's own bias. `faults` changes the reading before it is
  /// limited and quantised.
  ImuSample measure(const Motion& motion, const Vector3d& gyro_drift_body_radps = Vector3d::Zero(),
                    const std::function<void(ImuSample&)>& faults = {});

private:
  SensorSettings settings_;
  Random random_;
  Vector3d accel_bias_mps2_;
  Vector3d gyro_bias_radps_;
};

/// Angular velocity and specific force of an ideal IMU `lever_body_m` away from the tracked point.
ImuSample ideal_imu_sample(const Motion& motion, const Vector3d& lever_body_m = Vector3d::Zero());

/// Degradation of one fix compared to the others.
struct FixCondition {
  double noise_factor = 1;               ///< standard deviation in units of the run's fix noise
  std::optional<Range> quality_percent;  ///< reported, uniform; empty: as the settings say
};

/// Ultrasonic system of one beacon or pair.
class UltrasonicModel {
public:
  UltrasonicModel(const SensorSettings& settings, Random random);

  /// Fix rate of this run.
  [[nodiscard]] double fix_rate_hz() const { return fix_rate_hz_; }

  /// Delay from emission to receipt of the next fix, at least a millisecond.
  double next_delay_s();

  /// Measures a fix of this motion, without times and address.
  UltrasonicFix measure_fix(const Motion& motion, const FixCondition& condition = {});

  /// Measures the heading of this motion, without times and address. `error_rad` is added to the noise.
  PairHeading measure_heading(const Motion& motion, double error_rad = 0.0);

private:
  SensorSettings settings_;
  Random random_;
  double fix_rate_hz_;
  double fix_noise_m_;
};

/// Speed of the wheels of a vehicle that drives along body X.
class WheelModel {
public:
  WheelModel(SensorSettings settings, const Random& random)
      : settings_{std::move(settings)}, random_{random} {}

  /// Measures the speed of this motion, without times and address. The wheels turn by the share `slip`
  /// faster.
  TwistSample measure(const Motion& motion, double slip);

private:
  SensorSettings settings_;
  Random random_;
  double wander_ = 0;
};

}  // namespace sonopose::sim
