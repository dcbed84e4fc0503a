#pragma once
/// \file
/// Decides when a beacon is gone.

#include <sonopose/samples/time.hpp>

#include <cstdint>

namespace sonopose::presence {

/// Time of a beacon's last sample, and number of its samples.
struct BeaconPresence {
  SteadyTime latest;
  std::uint64_t samples = 0;

  void on_sample(SteadyTime now) noexcept {
    latest = now;
    ++samples;
  }

  /// True if it was heard for a while, unlike an address from noise on a line.
  [[nodiscard]] bool is_established() const noexcept {
    constexpr std::uint64_t min_samples = 100;  // one second of a beacon
    return samples >= min_samples;
  }

  /// True if the beacon has been silent for 60 s, or for 5 s if not established.
  [[nodiscard]] bool is_gone(SteadyTime now) const noexcept {
    constexpr TimeNs established_ns = 60'000'000'000;
    constexpr TimeNs other_ns = 5'000'000'000;
    return now - latest > (is_established() ? established_ns : other_ns);
  }
};

}  // namespace sonopose::presence
