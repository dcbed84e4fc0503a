#include <sonopose/fusion/kinematics.hpp>
#include <sonopose/math/rotation.hpp>

namespace sonopose::fusion {

std::optional<Vector3d> Kinematics::moved(TimeNs from_ns, TimeNs to_ns) const {
  const auto from = history.at(from_ns);
  const auto to = history.at(to_ns);
  if (!from || !to) return std::nullopt;
  return to->displacement_world_m - from->displacement_world_m +
         velocity_corrections_world_mps * seconds_between(from_ns, to_ns);
}

std::optional<double> Kinematics::yaw_at(TimeNs then_ns) const {
  const auto point = history.at(then_ns);
  if (!point) return std::nullopt;
  return math::wrap_angle(point->yaw_rad + yaw_corrections_rad);
}

}  // namespace sonopose::fusion
