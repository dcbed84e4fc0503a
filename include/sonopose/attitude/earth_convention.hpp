#pragma once
/// \file
/// The three usual conventions for axes on the Earth. In the project's world Z is up and magnetic north is
/// along `north_world`. These functions convert from it to a convention.

#include <sonopose/geometry/rotation.hpp>

#include <cmath>
#include <numbers>

namespace sonopose::attitude {

enum class Convention {
  nwu,  ///< X north, Y west, Z up
  enu,  ///< X east, Y north, Z up
  ned   ///< X north, Y east, Z down: NWU turned by 180° about X
};

template <class Scalar>
using Direction2 = Eigen::Matrix<Scalar, 2, 1>;

/// Rotation from the world to the convention. `north_world`: unit vector in the world's XY plane.
template <class Scalar>
geometry::Quaternion<Scalar> world_to_convention(Convention convention,
                                                 const Direction2<Scalar>& north_world) {
  if (convention == Convention::enu)
    return geometry::rotation_about_z(std::atan2(north_world.x(), north_world.y()));
  auto q_world_to_nwu = geometry::rotation_about_z(-std::atan2(north_world.y(), north_world.x()));
  if (convention == Convention::nwu) return q_world_to_nwu;
  return geometry::Quaternion<Scalar>(0, 1, 0, 0) * q_world_to_nwu;
}

/// Orientation of the body in the convention: turns body vectors into vectors of the convention.
template <class Scalar>
geometry::Quaternion<Scalar> orientation_in(Convention convention, const Direction2<Scalar>& north_world,
                                            const geometry::Quaternion<Scalar>& q_body_to_world) {
  return world_to_convention(convention, north_world) * q_body_to_world;
}

/// Converts a world vector to the convention.
template <class Scalar>
geometry::Vector3<Scalar> vector_in(Convention convention, const Direction2<Scalar>& north_world,
                                    const geometry::Vector3<Scalar>& vector_world) {
  return world_to_convention(convention, north_world) * vector_world;
}

/// World yaw of a body whose ZYX yaw in the convention is `yaw_rad`. World yaw is the direction of body X,
/// counter-clockwise from +X seen from above. ZYX yaw is counter-clockwise from north in NWU and from east in
/// ENU, clockwise from north in NED.
template <class Scalar>
Scalar yaw_in_world(Convention convention, const Direction2<Scalar>& north_world, Scalar yaw_rad) {
  const Scalar north_rad = std::atan2(north_world.y(), north_world.x());
  if (convention == Convention::enu)
    return geometry::wrap_angle(north_rad - std::numbers::pi_v<Scalar> / 2 + yaw_rad);
  return geometry::wrap_angle(convention == Convention::nwu ? north_rad + yaw_rad : north_rad - yaw_rad);
}

}  // namespace sonopose::attitude
