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

  /// Whether the beacon has been silent for 60 s, or for 5 s if it was hardly ever heard, such as an address
  /// that noise on a line gave.
  [[nodiscard]] bool is_gone(SteadyTime now) const noexcept {
    constexpr TimeNs long_ns = 60'000'000'000;
    constexpr TimeNs short_ns = 5'000'000'000;
    constexpr std::uint64_t hardly_any = 100;  // one second of a beacon
    return now - latest > (samples >= hardly_any ? long_ns : short_ns);
  }
};

}  // namespace sonopose::process
