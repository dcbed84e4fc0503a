#pragma once
/// \file
/// Shifts samples in time.

#include <sonopose/samples/samples.hpp>

namespace sonopose::bridge {

/// Returns the event, `shift_ns` later.
inline Event shifted(Event event, TimeNs shift_ns) {
  if (auto* imu = std::get_if<ImuSample>(&event)) {
    imu->sensor_time_ns = saturated_sum(imu->sensor_time_ns, shift_ns);
  }
  const auto shift = [shift_ns](auto* sample) {
    if (sample == nullptr) return;
    sample->emission_time_ns = saturated_sum(sample->emission_time_ns, shift_ns);
    sample->received_time_ns = saturated_sum(sample->received_time_ns, shift_ns);
  };
  shift(std::get_if<UltrasonicFix>(&event));
  shift(std::get_if<PairHeading>(&event));
  shift(std::get_if<TwistSample>(&event));
  return event;
}

inline TruthSample shifted(TruthSample truth, TimeNs shift_ns) {
  truth.time_ns = saturated_sum(truth.time_ns, shift_ns);
  return truth;
}

}  // namespace sonopose::bridge
