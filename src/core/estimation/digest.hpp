#pragma once
/// \file
/// A hash of a run's output, equal for two runs only if their bits are equal.

#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/samples/pose.hpp>

#include <cstdint>
#include <string>

namespace sonopose::estimation {

/// 64-bit digest of a sequence of values: Fowler–Noll–Vo 1a over whole words. Not for security.
class Digest {
public:
  void add(std::uint64_t word);
  void add(double value);  ///< adds its bits: 0.0 and −0.0 differ

  /// Adds time, position, attitude, velocity and status of a pose.
  void add(const FusedPose& pose);

  /// Adds every field of an estimator's state except its counters.
  void add(const AnySnapshot& snapshot);

  [[nodiscard]] std::uint64_t value() const { return value_; }

  /// Digest as 16 hexadecimal digits.
  [[nodiscard]] std::string text() const;

private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

}  // namespace sonopose::estimation
