#pragma once
/// \file
/// Random numbers that are the same wherever the program is built: the standard fixes the generator's bits
/// but not those of its distributions, so these are our own.

#include <sonopose/core/samples.hpp>

#include <cstdint>
#include <random>

namespace sonopose::sim {

/// One independent stream of random numbers. The same seed and stream give the same numbers.
class Random {
public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  /// Uniform in [0, 1), with all 53 bits of a double.
  double uniform();

  /// Gaussian with mean 0 and standard deviation 1 (Box-Muller).
  double normal();

  /// Three independent Gaussians.
  Vector3d normal_vector();

private:
  std::mt19937_64 generator_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace sonopose::sim
