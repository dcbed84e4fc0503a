#include "ros2/inputs/fix_repeats.hpp"

namespace sonopose::ros2 {

bool FixRepeats::is_new(const UltrasonicFix& fix) {
  const bool is_equal = latest_ && latest_->position_world_m == fix.position_world_m;
  const TimeNs passed_ns = latest_ ? fix.emission_time_ns - latest_->emission_time_ns : 0;
  if (is_equal) {
    has_repeats_ = true;
    if (passed_ns == 0) return false;  // the same message
    if (are_known() && passed_ns > 0 && passed_ns < hold_ns) return false;
    if (!are_known()) return true;  // perhaps at rest; a run is as long as since its first position
  } else if (latest_ && !are_known()) {
    const bool moves = (fix.position_world_m - latest_->position_world_m).norm() > moved_m;
    steps_ = moves && has_repeats_ && passed_ns < hold_ns ? steps_ + 1 : 0;
  }
  has_repeats_ = false;
  latest_ = fix;
  return true;
}

}  // namespace sonopose::ros2
