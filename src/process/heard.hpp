#pragma once
/// \file
/// Says when a beacon is gone.

#include <sonopose/samples/time.hpp>

#include <cstdint>

namespace sonopose::process {

/// When a beacon was last heard, and how often.
struct Heard {
  SteadyTime latest;
  std::uint64_t samples = 0;

  void on_sample(SteadyTime now) noexcept {
    latest = now;
    ++samples;
  }

  /// Whether it was heard for a while, unlike an address that noise on a line gave.
  [[nodiscard]] bool is_established() const noexcept {
    constexpr std::uint64_t least_samples = 100;  // one second of a beacon
    return samples >= least_samples;
  }

  /// Whether the beacon has been silent for 60 s, or for 5 s if it is not established.
  [[nodiscard]] bool is_gone(SteadyTime now) const noexcept {
    constexpr TimeNs established_ns = 60'000'000'000;
    constexpr TimeNs other_ns = 5'000'000'000;
    return now - latest > (is_established() ? established_ns : other_ns);
  }
};

}  // namespace sonopose::process
