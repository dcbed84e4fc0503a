#include <sonopose/attitude/tracker.hpp>

namespace sonopose::attitude {

Quaterniond first_orientation(const Measurement<double>& measurement) {
  const Vector3d& force_body_mps2 = measurement.specific_force_body_mps2;
  if (force_body_mps2.isZero(0)) return Quaterniond::Identity();
  const Quaterniond q_level = geometry::level_with(force_body_mps2, 0.0);
  const Vector3d field_world_t = q_level * measurement.magnetic_field_body_t;
  if (field_world_t.head<2>().isZero(0)) return q_level;
  const double north_rad = std::atan2(measurement.north_world.y(), measurement.north_world.x());
  const double seen_rad = std::atan2(field_world_t.y(), field_world_t.x());
  return geometry::rotation_about_z(north_rad - seen_rad) * q_level;
}

}  // namespace sonopose::attitude
