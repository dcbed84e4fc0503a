#pragma once
/// \file
/// A sensor with known errors, held still in successive orientations.

#include "sim/random.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace sonopose::test {

/// Errors of the sensor, the inverse of the wanted calibration: raw = gain · true + offset.
struct SensorErrors {
  Eigen::Matrix3d gyro_gain = Eigen::Matrix3d::Identity();
  Vector3d gyro_offset_radps = Vector3d::Zero();
  Eigen::Matrix3d accel_gain = Eigen::Matrix3d::Identity();
  Vector3d accel_offset_mps2 = Vector3d::Zero();
  double gyro_noise_radps = 0.002;  ///< per sample and axis
  double accel_noise_mps2 = 0.02;
};

/// Directions to the sides and corners of a cube.
inline std::vector<Vector3d> sides_of_a_cube() {
  return {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
}
inline std::vector<Vector3d> sides_and_corners_of_a_cube() {
  std::vector<Vector3d> directions = sides_of_a_cube();
  for (const double x : {1.0, -1.0}) {
    for (const double y : {1.0, -1.0}) {
      for (const double z : {x * y, -x * y}) directions.emplace_back(Vector3d(x, y, z).normalized());
    }
  }
  return directions;
}

/// Samples at 100 Hz: 2 s still with each of `up_body` upwards, turns of 1 s in between.
class SimulatedSensor {
public:
  SimulatedSensor(SensorErrors errors, std::uint64_t seed) : errors_(std::move(errors)), random_(seed) {}

  std::vector<ImuSample> hold_in_turn(const std::vector<Vector3d>& up_body) {
    Quaterniond q = geometry::rotation_between(up_body.front(), Vector3d::UnitZ());
    hold(q, 2.0);
    for (std::size_t i = 1; i < up_body.size(); ++i) {
      const Quaterniond next = geometry::rotation_between(up_body[i], Vector3d::UnitZ());
      turn(q, next);
      q = next;
      hold(q, 2.0);
    }
    return samples_;
  }

  void hold(const Quaterniond& q_body_to_world, double duration_s) {
    for (double t = 0.0; t < duration_s - 0.5 * dt_s_; t += dt_s_) measure(q_body_to_world, Vector3d::Zero());
  }

  /// Turns about one axis within 1 s; the rate follows sin².
  void turn(const Quaterniond& from, const Quaterniond& to) {
    const Eigen::AngleAxisd whole(Quaterniond(from.conjugate() * to));
    for (double t = 0.5 * dt_s_; t < 1.0; t += dt_s_) {
      const double share = t - std::sin(2.0 * std::numbers::pi * t) / (2.0 * std::numbers::pi);
      const double rate_radps = whole.angle() * (1.0 - std::cos(2.0 * std::numbers::pi * t));
      measure(from * geometry::rotation_by(Vector3d(share * whole.angle() * whole.axis())),
              rate_radps * whole.axis());
    }
  }

  [[nodiscard]] std::vector<ImuSample>& samples() { return samples_; }

private:
  void measure(const Quaterniond& q_body_to_world, const Vector3d& rate_radps) {
    ImuSample sample;
    sample.sensor_time_ns = 1'700'000'000'000'000'000 + to_ns(dt_s_ * static_cast<double>(samples_.size()));
    sample.angular_velocity_body_radps = errors_.gyro_gain * rate_radps + errors_.gyro_offset_radps +
                                         errors_.gyro_noise_radps * random_.normal_vector();
    const Vector3d force_mps2 = standard_gravity_mps2 * geometry::up_in_body(q_body_to_world);
    sample.specific_force_body_mps2 = errors_.accel_gain * force_mps2 + errors_.accel_offset_mps2 +
                                      errors_.accel_noise_mps2 * random_.normal_vector();
    samples_.push_back(sample);
  }

  SensorErrors errors_;
  sim::Random random_;
  double dt_s_ = 0.01;
  std::vector<ImuSample> samples_;
};

}  // namespace sonopose::test
