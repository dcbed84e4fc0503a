#include <sonopose/estimation/aiding/default_position.hpp>

#include <algorithm>

namespace sonopose::estimation::aiding {

bool is_same_position(const Vector3d& a_world_m, const Vector3d& b_world_m) {
  constexpr double same_coordinate_m = 0.0005;  // half the finest resolution of a beacon
  return (a_world_m - b_world_m).cwiseAbs().maxCoeff() < same_coordinate_m;
}

bool DefaultPosition::add(TimeNs time_ns, const Vector3d& position_world_m) {
  constexpr double away_m = 0.3;
  constexpr double memory_s = 60.0;
  constexpr int max_in_row = 20;  // afterwards the body may really be there
  constexpr int places = static_cast<int>(capacity);
  bool was_away = false;
  bool returned = false;
  for (int i = 1; i <= std::min(fixes, places) && !returned; ++i) {
    const Vector3d& before = recent[static_cast<std::size_t>((fixes - i) % places)].position_world_m;
    returned = was_away && is_same_position(before, position_world_m);
    was_away = was_away || (before - position_world_m).norm() > away_m;
  }
  recent[static_cast<std::size_t>(fixes % places)].position_world_m = position_world_m;
  fixes = fixes + 1 == 2 * places ? places : fixes + 1;
  if (is_known && seconds_between(seen_ns, time_ns) > memory_s) is_known = false;
  if (returned && !(is_known && is_same_position(default_world_m, position_world_m))) {
    is_known = true;
    default_world_m = position_world_m;
    in_row = 0;
    seen_ns = time_ns;
  }
  if (!is_known) return false;
  if (!is_same_position(default_world_m, position_world_m)) {
    in_row = 0;
    return false;
  }
  seen_ns = time_ns;
  in_row = std::min(in_row + 1, max_in_row);
  return in_row < max_in_row;
}

bool DefaultPosition::is_active(TimeNs now_ns) const {
  constexpr double active_s = 3.0;
  return is_known && seconds_between(seen_ns, now_ns) < active_s;
}

}  // namespace sonopose::estimation::aiding
