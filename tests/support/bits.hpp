#pragma once
/// \file
/// Engine output as bits for strict equality: 0 differs from -0, and a NaN equals itself. Excludes latency
/// stamps.

#include <sonopose/samples/pose.hpp>

#include <bit>
#include <cstdint>
#include <vector>

namespace sonopose::test {

using Bits = std::vector<std::uint64_t>;

namespace detail {

inline void append(Bits& bits, double value) {
  bits.push_back(std::bit_cast<std::uint64_t>(value));
}

inline void append(Bits& bits, const Vector3d& vector) {
  for (const double value : vector) append(bits, value);
}

}  // namespace detail

inline Bits bits_of(const FusedPose& pose) {
  Bits bits{pose.address,       pose.sequence, static_cast<std::uint64_t>(pose.time_ns),
            pose.reset_counter, pose.status,   static_cast<std::uint64_t>(pose.imu_sensor_time_ns)};
  for (const Vector3d& vector :
       {pose.position_world_m, pose.velocity_world_mps, pose.angular_velocity_body_radps,
        pose.acceleration_world_mps2, pose.gyro_bias_body_radps}) {
    detail::append(bits, vector);
  }
  for (const double value : pose.q_body_to_world.coeffs()) detail::append(bits, value);
  for (const double value : {pose.trust, pose.since_valid_fix_s}) {
    detail::append(bits, value);
  }
  for (const double value : pose.pose_covariance.elements()) detail::append(bits, value);
  for (const double value : pose.velocity_covariance.elements()) detail::append(bits, value);
  return bits;
}

inline Bits bits_of(const FixReport& report) {
  Bits bits{report.address,
            report.sequence,
            static_cast<std::uint64_t>(report.emission_time_ns),
            static_cast<std::uint64_t>(report.applied_time_ns),
            report.hypothesis,
            report.model,
            report.flags};
  for (const Vector3d& vector :
       {report.position_world_m, report.shifted_position_world_m, report.innovation_world_m,
        report.jump_world_m, report.velocity_change_world_mps}) {
    detail::append(bits, vector);
  }
  for (const double value : {report.weight, report.trust, report.yaw_change_rad}) detail::append(bits, value);
  bits.push_back(report.test_ratio ? 1 : 0);
  if (report.test_ratio) detail::append(bits, *report.test_ratio);
  bits.push_back(report.innovation_covariance_m2 ? 1 : 0);
  if (report.innovation_covariance_m2) {
    for (const double value : report.innovation_covariance_m2->elements()) detail::append(bits, value);
  }
  return bits;
}

}  // namespace sonopose::test
