#pragma once
/// \file
/// Random numbers that are reproducible across platforms: the C++ standard specifies the bits of its
/// generators but not of its distributions.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <random>

namespace sonopose::sim {

/// All numbers from `min` to `max`. A single number converts to the range that contains only it.
struct Range {
  double min = 0;
  double max = 0;

  constexpr Range() = default;
  constexpr Range(double value) : min{value}, max{value} {}  // NOLINT(google-explicit-constructor)
  constexpr Range(double min_in, double max_in) : min{min_in}, max{max_in} {}
};

/// One independent stream of random numbers. The same seed and stream give the same numbers.
class Random {
public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  /// Uniform in [0, 1), with all 53 bits of a double.
  double uniform();

  /// Uniform in the range; exact if the range has only one value.
  double uniform_in(const Range& range);

  /// Uniform over the whole numbers from `min` to `max`.
  int integer_in(int min, int max);

  /// Gaussian with mean 0 and standard deviation 1 (Box-Muller).
  double normal();

  /// Three independent Gaussians.
  Vector3d normal_vector();

  /// A unit vector, uniform over all directions in space.
  Vector3d direction();

  /// A unit vector, uniform over all horizontal directions.
  Vector3d horizontal_direction();

private:
  std::mt19937_64 generator_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace sonopose::sim
