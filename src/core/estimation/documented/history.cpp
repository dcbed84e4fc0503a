#include <sonopose/estimation/documented/history.hpp>
#include <sonopose/geometry/rotation.hpp>

namespace sonopose::estimation::documented {

void InertialHistory::push(const InertialPoint& point) {
  const bool replaces = size_ >= 2 && newest().time_ns - back(1).time_ns < spacing_ns;
  if (!replaces) {
    last_ = size_ == 0 ? 0 : (last_ + 1) % capacity;
    if (size_ < capacity) ++size_;
  }
  points_[last_] = point;
}

std::optional<InertialPoint> InertialHistory::at(TimeNs time_ns) const {
  if (size_ == 0) return std::nullopt;
  if (time_ns >= newest().time_ns) return newest();
  for (std::size_t steps = 1; steps < size_; ++steps) {
    const InertialPoint& before = back(steps);
    if (before.time_ns > time_ns) continue;
    const InertialPoint& after = back(steps - 1);
    const double span_s = seconds_between(before.time_ns, after.time_ns);
    const double share = span_s > 0.0 ? seconds_between(before.time_ns, time_ns) / span_s : 1.0;
    return InertialPoint{
        time_ns,
        before.displacement_world_m + share * (after.displacement_world_m - before.displacement_world_m),
        before.yaw_rad + share * geometry::wrap_angle(after.yaw_rad - before.yaw_rad)};
  }
  return std::nullopt;
}

bool InertialHistory::operator==(const InertialHistory& other) const {
  if (size_ != other.size_) return false;
  for (std::size_t i = 0; i < size_; ++i) {
    if (!((*this)[i] == other[i])) return false;
  }
  return true;
}

}  // namespace sonopose::estimation::documented
