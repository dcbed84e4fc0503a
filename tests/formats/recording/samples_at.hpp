#pragma once
/// \file
/// Samples with only a time and an address.

#include <sonopose/samples/samples.hpp>

namespace sonopose::test {

inline ImuSample imu_at(TimeNs time_ns, BeaconAddress address = 7) {
  ImuSample sample;
  sample.address = address;
  sample.sensor_time_ns = time_ns;
  return sample;
}

inline UltrasonicFix fix_at(TimeNs received_ns, BeaconAddress address = 7) {
  UltrasonicFix fix;
  fix.address = address;
  fix.emission_time_ns = received_ns;
  fix.received_time_ns = received_ns;
  return fix;
}

inline PairHeading heading_at(TimeNs received_ns, BeaconAddress address = 7) {
  PairHeading heading;
  heading.address = address;
  heading.emission_time_ns = received_ns;
  heading.received_time_ns = received_ns;
  return heading;
}

}  // namespace sonopose::test
