#pragma once
/// \file
/// A hash that is equal for two runs only if their results are bit-identical.

#include <sonopose/estimation/documented/state.hpp>
#include <sonopose/samples/pose.hpp>

#include <cstdint>
#include <string>

namespace sonopose::evaluation {

/// 64-bit hash of a sequence of values: Fowler–Noll–Vo 1a over whole words. Not cryptographic.
class Digest {
public:
  void add(std::uint64_t word);
  void add(double value);  ///< by its bits: 0.0 and −0.0 differ

  /// Adds time, position, attitude, velocity and status of a pose.
  void add(const FusedPose& pose);

  /// Adds every field of an engine's state.
  void add(const estimation::documented::State& state);

  [[nodiscard]] std::uint64_t value() const { return value_; }

  /// As 16 hexadecimal digits.
  [[nodiscard]] std::string text() const;

private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

}  // namespace sonopose::evaluation
