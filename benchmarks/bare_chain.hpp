#pragma once
// The lower bound for DDS: source → relay → sink in Cyclone's C API, with the payloads and the QoS of the
// real chain.

#include <cstdint>

namespace sonopose::benchmarks {

/// Publishes IMU samples at `rate_hz` until the process is killed.
void run_bare_source(std::uint32_t domain, double rate_hz);

/// Takes each IMU sample in a listener and writes a pose with its stamps until the process is killed.
void run_bare_relay(std::uint32_t domain);

}  // namespace sonopose::benchmarks
