#pragma once
/// \file
/// What the beacon's sensors make of a motion: an IMU with bias, noise and quantisation, and the ultrasonic
/// fixes and pair headings with noise and delay.

#include <sonopose/samples/samples.hpp>
#include <sonopose/geometry/rotation.hpp>
#include "sim/random.hpp"
#include "sim/trajectory.hpp"

#include <optional>

namespace sonopose::sim {

/// How good the sensors are. Noises are standard deviations; 0 switches one off. What is given as a range is
/// drawn once per run.
struct SensorSettings {
  double imu_rate_hz = 100.0;
  double accel_noise_mps2 = 0.02;            ///< per sample and axis
  double gyro_noise_radps = 0.002;           ///< per sample and axis
  double accel_bias_mps2 = 0.03;             ///< spread of the constant bias over the seeds, per axis
  double gyro_bias_radps = 0.01;             ///< spread of the constant bias over the seeds, per axis
  double accel_bias_walk_mps2_rts = 0.0005;  ///< growth of the bias, per √s
  double gyro_bias_walk_radps_rts = 0.0001;  ///< growth of the bias, per √s
  bool imu_quantised = true;                 ///< 1 mg and 0.0175 deg/s in 16 bits, as the beacon sends it
  Vector3d imu_from_tracked_point_body_m = Vector3d::Zero();  ///< lever arm: where the IMU sits

  Range fix_rate_hz{8.0, 16.0};     ///< 0: no fixes and no headings
  Range fix_noise_m{0.015, 0.025};  ///< per axis
  double fix_delay_s = 0.068;
  double fix_delay_jitter_s = 0.003;
  double quality_percent = 90.0;
  double quality_noise_percent = 3.0;

  bool pair_heading = true;  ///< false: a single beacon, no headings
  double heading_noise_rad = 0.8 * geometry::radians_per_degree;
  double pair_mount_offset_rad = 0.0;  ///< direction of the pair's axis in the body, from body X to the left

  /// Perfect sensors: no noise, bias, jitter or quantisation; 12 fixes per second, delay as above.
  static SensorSettings ideal();
};

/// Throws std::invalid_argument that names the field which no sensor can have.
void check(const SensorSettings& settings);

/// The IMU of one beacon: its bias lives here.
class ImuModel {
public:
  ImuModel(const SensorSettings& settings, const Random& random);

  /// Next sample, taken on this motion; stamps, address and number are the caller's. `gyro_drift_body_radps`
  /// adds to the bias that the sensor has of its own.
  ImuSample measure(const Motion& motion, const Vector3d& gyro_drift_body_radps = Vector3d::Zero());

private:
  SensorSettings settings_;
  Random random_;
  Vector3d accel_bias_mps2_;
  Vector3d gyro_bias_radps_;
};

/// Angular velocity and specific force of a perfect IMU `lever_body_m` away from the tracked point.
ImuSample ideal_imu_sample(const Motion& motion, const Vector3d& lever_body_m = Vector3d::Zero());

/// In which way one fix is worse than the others.
struct FixCondition {
  double noise_factor = 1;               ///< standard deviation in units of the run's fix noise
  std::optional<Range> quality_percent;  ///< reported, uniform; empty: as the settings say
};

/// The ultrasonic system as seen from one beacon or pair.
class UltrasonicModel {
public:
  UltrasonicModel(const SensorSettings& settings, Random random);

  /// The rate of this run.
  [[nodiscard]] double fix_rate_hz() const { return fix_rate_hz_; }

  /// Emission to receipt of the next fix, never less than a millisecond.
  double next_delay_s();

  /// A fix on this motion, its times and address not yet set.
  UltrasonicFix measure_fix(const Motion& motion, const FixCondition& condition = {});

  /// The heading that comes with it, its times and address not yet set.
  PairHeading measure_heading(const Motion& motion);

private:
  SensorSettings settings_;
  Random random_;
  double fix_rate_hz_;
  double fix_noise_m_;
};

}  // namespace sonopose::sim
