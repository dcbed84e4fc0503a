#pragma once
/// \file
/// Identifies a process among others of its kind on the bus.

#include <cstdint>
#include <random>

namespace sonopose::process {

/// Returns 64 random bits. Two processes get the same ones only with probability 2^-64.
inline std::uint64_t random_id() {
  std::random_device device;
  return (std::uint64_t{device()} << 32U) | device();
}

}  // namespace sonopose::process
