#pragma once
/// \file
/// Shared by the AHRS tests: sensors of a body of known orientation, and filters that have settled on it.

#include <sonopose/attitude/ahrs.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/samples.hpp>

#include <cmath>

namespace sonopose::testing {

using attitude::Ahrs;
using attitude::AhrsSettings;
using attitude::RejectionForm;

inline constexpr double step_s = 0.01;
inline constexpr double degree = geometry::radians_per_degree;

/// Largest angle due to rounding; the fast inverse square root's error exceeds it.
#ifdef SONOPOSE_FAST_INVERSE_SQRT
inline constexpr double rounding_rad = 1e-5;
#else
inline constexpr double rounding_rad = 1e-9;
#endif
inline const Vector3d up_world(0, 0, 1);

/// Readings of perfect sensors on a body at rest; the field dips by 60°.
inline attitude::Measurement<double> at_rest(const Quaterniond& q_body_to_world,
                                             const Eigen::Vector2d& north_world = {0, 1}) {
  attitude::Measurement<double> m;
  m.dt_s = step_s;
  m.north_world = north_world;
  m.specific_force_body_mps2 = q_body_to_world.conjugate() * (standard_gravity_mps2 * up_world);
  m.magnetic_field_body_t =
      q_body_to_world.conjugate() * Vector3d(25e-6 * north_world.x(), 25e-6 * north_world.y(), -43e-6);
  return m;
}

inline attitude::Measurement<double> without_field(attitude::Measurement<double> m) {
  m.magnetic_field_body_t.setZero();
  return m;
}

inline attitude::Measurement<double> gyroscope_alone(attitude::Measurement<double> m) {
  m.specific_force_body_mps2.setZero();
  m.magnetic_field_body_t.setZero();
  return m;
}

inline void run(Ahrs& filter, const AhrsSettings& settings, const attitude::Measurement<double>& m,
                double seconds) {
  for (long i = 0; i < std::lround(seconds / m.dt_s); ++i) filter.update(settings, m);
}

/// A filter past its initialisation, with the true orientation.
inline Ahrs settled_at(const Quaterniond& q_body_to_world, const AhrsSettings& settings = {}) {
  Ahrs filter;
  filter.reset(q_body_to_world);
  run(filter, settings, at_rest(q_body_to_world), 3.1);
  return filter;
}

/// Angle between estimated and true up.
inline double tilt_error_rad(const Ahrs& filter, const Quaterniond& q_body_to_world) {
  const Vector3d estimated = geometry::up_in_body(filter.orientation());
  const Vector3d truth = geometry::up_in_body(q_body_to_world);
  return std::atan2(estimated.cross(truth).norm(), estimated.dot(truth));
}

inline double distance_rad(const Ahrs& filter, const Quaterniond& q_body_to_world) {
  return filter.orientation().angularDistance(q_body_to_world);
}

}  // namespace sonopose::testing
