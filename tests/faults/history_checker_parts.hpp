#pragma once
/// \file
/// Helpers shared by the parts of the checker.

#include "faults/history.hpp"

namespace sonopose::faults {

inline double to_ms(TimeNs duration_ns) {
  return static_cast<double>(duration_ns) * 1e-6;
}

/// Age of the pose's sample when it left the bridge, by the bridge's clock.
inline TimeNs transit_ns(const Arrival& pose) {
  return saturated_difference(pose.bridge_time_ns, pose.time_ns);
}

inline bool overlap(const Interval& interval, SteadyTime from, SteadyTime until) {
  return interval.from <= until && interval.until >= from;
}

}  // namespace sonopose::faults
