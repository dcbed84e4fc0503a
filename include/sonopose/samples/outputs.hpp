#pragma once
/// \file
/// The part of an estimator's output that its input determines.

#include <sonopose/samples/pose.hpp>

namespace sonopose {

/// Returns a report that names the fix and the time of its application.
inline FixReport report_on(const UltrasonicFix& fix, TimeNs applied_time_ns) {
  FixReport report;
  report.address = fix.address;
  report.sequence = fix.sequence;
  report.emission_time_ns = fix.emission_time_ns;
  report.applied_time_ns = applied_time_ns;
  report.position_world_m = fix.position_world_m;
  return report;
}

}  // namespace sonopose
