#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>

namespace sonopose::estimation::documented {

std::optional<Vector3d> Kinematics::displacement_between(TimeNs from_ns, TimeNs to_ns) const {
  const auto from = history.at(from_ns);
  const auto to = history.at(to_ns);
  if (!from || !to) return std::nullopt;
  const TimeNs known_from_ns = std::min(from_ns, time_ns);
  const TimeNs known_to_ns = std::min(to_ns, time_ns);
  const double ahead_s = seconds_between(known_to_ns, to_ns) - seconds_between(known_from_ns, from_ns);
  return to->displacement_world_m - from->displacement_world_m +
         velocity_corrections_world_mps * seconds_between(known_from_ns, known_to_ns) +
         velocity_world_mps * ahead_s;
}

std::optional<double> Kinematics::yaw_at(TimeNs then_ns) const {
  const auto point = history.at(then_ns);
  if (!point) return std::nullopt;
  return geometry::wrap_angle(point->yaw_rad + yaw_corrections_rad);
}

}  // namespace sonopose::estimation::documented
