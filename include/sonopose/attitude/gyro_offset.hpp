#pragma once
/// \file
/// The gyroscope offset correction of the AHRS document. Once the body has stood still for long enough, the
/// remaining rate is low-pass filtered into the offset.

#include <sonopose/geometry/rotation.hpp>

namespace sonopose::attitude {

template <class Scalar>
struct GyroOffsetLimits {
  Scalar rate_radps;  ///< largest rate about an axis, less the learned offset, that counts as still
  Scalar still_s;     ///< time at rest before learning starts
  Scalar cutoff_hz;   ///< cutoff of the low-pass filter
};

template <class Scalar>
struct GyroOffset {
  geometry::Vector3<Scalar> offset_body_radps = geometry::Vector3<Scalar>::Zero();
  Scalar still_s = 0;  ///< time at rest so far, up to the limit

  /// Learns from one measured rate (rad/s, body) over `dt_s`.
  void learn(const GyroOffsetLimits<Scalar>& limits,
             const geometry::Vector3<Scalar>& angular_velocity_body_radps, Scalar dt_s);

  bool operator==(const GyroOffset&) const = default;
};

extern template struct GyroOffset<float>;
extern template struct GyroOffset<double>;

}  // namespace sonopose::attitude
