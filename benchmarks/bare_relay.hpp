#pragma once
// The lower bound of the ROS 2 relay: a process that reads and writes the same messages with bare Cyclone DDS
// and computes nothing.

#include <cstdint>

namespace sonopose::benchmarks {

inline constexpr std::uint32_t first_relayed_address = 7;

/// Relays until it is killed. Throws std::runtime_error.
[[noreturn]] void relay_bare(std::uint32_t domain, std::uint32_t beacons);

/// Subscribes to the messages of every beacon like a ROS 2 node, and discards them, until it is killed.
/// Throws std::runtime_error.
[[noreturn]] void consume_relayed(std::uint32_t domain, std::uint32_t beacons);

}  // namespace sonopose::benchmarks
