#pragma once
/// \file
/// The AHRS document's gyroscope offset correction: while the body has stood still for long enough, what the
/// gyroscope still reads is low-pass filtered into its offset.

#include <sonopose/geometry/rotation.hpp>

namespace sonopose::attitude {

template <class Scalar>
struct GyroOffsetLimits {
  Scalar rate_radps;  ///< still: no component, less the learned offset, above this
  Scalar still_s;     ///< for so long before anything is learned
  Scalar cutoff_hz;   ///< of the low-pass filter
};

template <class Scalar>
struct GyroOffset {
  geometry::Vector3<Scalar> offset_body_radps = geometry::Vector3<Scalar>::Zero();
  Scalar still_s = 0;  ///< so long it has stood still, up to the limit

  /// Learns from one rate (rad/s, body, as measured) over `dt_s`.
  void learn(const GyroOffsetLimits<Scalar>& limits,
             const geometry::Vector3<Scalar>& angular_velocity_body_radps, Scalar dt_s);

  bool operator==(const GyroOffset&) const = default;
};

extern template struct GyroOffset<float>;
extern template struct GyroOffset<double>;

}  // namespace sonopose::attitude
