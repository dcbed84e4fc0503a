#pragma once
/// \file
/// Identifies a process among others of its kind on the bus.

#include <cstdint>
#include <random>

namespace sonopose::process {

/// 64 random bits: two processes have the same ones only with probability 2^-64.
inline std::uint64_t random_id() {
  std::random_device device;
  return (std::uint64_t{device()} << 32U) | device();
}

}  // namespace sonopose::process
