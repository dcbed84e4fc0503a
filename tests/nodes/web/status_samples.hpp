#pragma once
/// \file
/// Statuses with one known value.

#include <sonopose/samples/status.hpp>

#include <optional>

namespace sonopose::test {

inline BeaconStatus battery_status(BeaconAddress address, TimeNs time_ns, std::optional<double> battery_v) {
  BeaconStatus status;
  status.address = address;
  status.time_ns = time_ns;
  status.battery_v = battery_v;
  return status;
}

inline Estimate delay_estimate(BeaconAddress address, std::uint64_t fusion_id, TimeNs time_ns,
                               double delay_s) {
  Estimate estimate;
  estimate.address = address;
  estimate.fusion_id = fusion_id;
  estimate.time_ns = time_ns;
  estimate.delay_s = ScalarEstimate{delay_s, 0.01};
  return estimate;
}

}  // namespace sonopose::test
