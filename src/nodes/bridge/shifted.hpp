#pragma once
/// \file
/// Shifts samples in time.

#include <sonopose/samples/samples.hpp>

namespace sonopose::bridge {

/// Returns the event, `shift_ns` later.
inline Event shifted(Event event, TimeNs shift_ns) {
  if (auto* imu = std::get_if<ImuSample>(&event)) {
    imu->sensor_time_ns = saturated_sum(imu->sensor_time_ns, shift_ns);
  } else if (auto* fix = std::get_if<UltrasonicFix>(&event)) {
    fix->emission_time_ns = saturated_sum(fix->emission_time_ns, shift_ns);
    fix->received_time_ns = saturated_sum(fix->received_time_ns, shift_ns);
  } else {
    auto& heading = std::get<PairHeading>(event);
    heading.emission_time_ns = saturated_sum(heading.emission_time_ns, shift_ns);
    heading.received_time_ns = saturated_sum(heading.received_time_ns, shift_ns);
  }
  return event;
}

inline TruthSample shifted(TruthSample truth, TimeNs shift_ns) {
  truth.time_ns = saturated_sum(truth.time_ns, shift_ns);
  return truth;
}

}  // namespace sonopose::bridge
