#pragma once
/// \file
/// The concept of an attitude filter: a value that turns measurements and settings into an orientation. All
/// filters of this module model it. Any can replace any other, at compile time (template argument) or at run
/// time (any_filter.hpp).

#include <sonopose/geometry/rotation.hpp>

#include <cmath>
#include <concepts>
#include <limits>
#include <string_view>

namespace sonopose::attitude {

using geometry::Quaternion;
using geometry::Vector3;

/// Input of one filter step. All numbers must be finite.
template <class Scalar>
struct Measurement {
  Scalar dt_s = 0;  ///< time since the previous measurement, ≥ 0; may vary
  Vector3<Scalar> angular_velocity_body_radps = Vector3<Scalar>::Zero();
  Vector3<Scalar> specific_force_body_mps2 = Vector3<Scalar>::Zero();  ///< zero length: not measured
  Vector3<Scalar> magnetic_field_body_t = Vector3<Scalar>::Zero();     ///< zero length: not measured
  /// Unit vector to magnetic north in the world's XY plane: (0, 1) if X is east, (1, 0) if X is north.
  Eigen::Matrix<Scalar, 2, 1> north_world{0, 1};
  /// Acceleration of the body known from another source (m/s²). The rest of the specific force is due to
  /// gravity.
  Vector3<Scalar> acceleration_world_mps2 = Vector3<Scalar>::Zero();
  /// False if the body may accelerate in unknown ways. The specific force then serves rest detection alone.
  bool force_shows_vertical = true;
};

/// Specific force without the known acceleration of the body: the reaction to gravity.
template <class Scalar>
Vector3<Scalar> gravity_force_body(const Measurement<Scalar>& measurement,
                                   const Quaternion<Scalar>& q_body_to_world) {
  if (measurement.acceleration_world_mps2.isZero(0)) return measurement.specific_force_body_mps2;
  return measurement.specific_force_body_mps2 -
         q_body_to_world.conjugate() * measurement.acceleration_world_mps2;
}

/// True if the specific force is present and shows the vertical.
template <class Scalar>
bool has_vertical_reference(const Measurement<Scalar>& measurement) {
  return measurement.force_shows_vertical && !measurement.specific_force_body_mps2.isZero(0);
}

/// True if a world vector has a horizontal direction: its horizontal part exceeds rounding errors.
template <class Scalar>
bool has_level_part(const Vector3<Scalar>& vector_world) {
  constexpr Scalar min_ratio = 16 * std::numeric_limits<Scalar>::epsilon();
  return vector_world.template head<2>().squaredNorm() > min_ratio * min_ratio * vector_world.squaredNorm();
}

/// Angle about the vertical from the level part of `field_world_t` to north. The level part must not be zero.
template <class Scalar>
Scalar heading_error_rad(const Vector3<Scalar>& field_world_t, const Measurement<Scalar>& measurement) {
  const auto& north = measurement.north_world;
  return std::atan2(field_world_t.x() * north.y() - field_world_t.y() * north.x(),
                    field_world_t.x() * north.x() + field_world_t.y() * north.y());
}

/// Accepts the fields of any filter.
struct NullFieldVisitor {
  template <class Field>
  void operator()(const char* /*name*/, Field& /*field*/) const {}
};

// clang-format off
/// An attitude filter. Orientations are `q_body_to_world`; the world's Z is up. A default-constructed filter
/// has the identity orientation and has learned nothing.
///
/// | Member | Effect |
/// |---|---|
/// | `reset(q)` | restarts at this orientation and forgets the learned gyroscope offset |
/// | `update(settings, m)` | performs one step; allocates nothing and never throws |
/// | `turn_in_world(v)` | turns the estimate by a rotation vector in the world (rad) |
/// | `gyro_bias_body_radps()`, `set_gyro_bias(b)` | offset that is subtracted from the rates (rad/s, body) |
/// | `for_each_field(f)` | calls f(name, field) for each field of the state, to save and restore it; fields are bool, int, Scalar, Vector3, Matrix3 and Quaternion |
// clang-format on
template <class F>
concept Filter = std::regular<F> &&
    requires(F filter, const F seen, const typename F::Settings settings,
             const Measurement<typename F::Scalar> measurement,
             const Quaternion<typename F::Scalar> q_body_to_world, const Vector3<typename F::Scalar> vector) {
  { F::name } -> std::convertible_to<std::string_view>;
  filter.reset(q_body_to_world);
  filter.update(settings, measurement);
  filter.turn_in_world(vector);
  filter.set_gyro_bias(vector);
  filter.for_each_field(NullFieldVisitor{});
  { seen.orientation() } -> std::convertible_to<Quaternion<typename F::Scalar>>;
  { seen.gyro_bias_body_radps() } -> std::convertible_to<Vector3<typename F::Scalar>>;
};

}  // namespace sonopose::attitude
