#pragma once
/// \file
/// A tilt-compensated compass: heading from one accelerometer and one magnetometer measurement at rest.

#include <sonopose/attitude/earth_convention.hpp>

#include <limits>
#include <optional>

namespace sonopose::attitude {

/// ZYX yaw of the body in the convention (rad), at any tilt. `specific_force_body` points up; both vectors
/// may have any length. Empty if one is zero, both are parallel or body X is vertical.
template <class Scalar>
std::optional<Scalar> compass_heading(Convention convention,
                                      const geometry::Vector3<Scalar>& specific_force_body,
                                      const geometry::Vector3<Scalar>& magnetic_field_body) {
  constexpr Scalar tiny = std::numeric_limits<Scalar>::epsilon();
  const geometry::Vector3<Scalar> up_body = specific_force_body.stableNormalized();
  const geometry::Vector3<Scalar> west_body = up_body.cross(magnetic_field_body.stableNormalized());
  const geometry::Vector3<Scalar> north_body = west_body.cross(up_body);
  // Components of body X to the north and to the west, seen from above.
  const Scalar north = north_body.x();
  const Scalar west = west_body.x();
  if (std::hypot(north, west) <= 4 * tiny) return std::nullopt;
  switch (convention) {
    case Convention::nwu:
      return std::atan2(west, north);
    case Convention::enu:
      return std::atan2(north, -west);
    case Convention::ned:
      break;
  }
  return std::atan2(-west, north);
}

}  // namespace sonopose::attitude
