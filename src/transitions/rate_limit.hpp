#pragma once
/// \file
/// Bounds how often one thing is logged.

#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <utility>

namespace sonopose::transitions {

/// Admits some lines within a time, and counts the others. Not thread-safe.
class RateLimit {
public:
  /// Two beginnings and two ends: a state that changes more often is flapping.
  static constexpr std::uint64_t default_most_lines = 4;
  static constexpr TimeNs window_ns = 60'000'000'000;

  explicit RateLimit(std::uint64_t most_lines = default_most_lines) noexcept : most_lines_(most_lines) {}

  /// Whether a line may be logged at `now`; otherwise it counts as suppressed.
  bool admits(SteadyTime now) noexcept {
    if (lines_ == 0 || is_over(now)) {
      began_ = now;
      lines_ = 0;
    }
    if (lines_ == most_lines_) {
      ++suppressed_;
      return false;
    }
    ++lines_;
    return true;
  }

  /// Whether lines were suppressed and not taken.
  [[nodiscard]] bool has_suppressed() const noexcept { return suppressed_ > 0; }

  /// Whether lines were suppressed, and the time is over.
  [[nodiscard]] bool owes_report(SteadyTime now) const noexcept { return has_suppressed() && is_over(now); }

  /// The lines suppressed since the last call.
  std::uint64_t take_suppressed() noexcept { return std::exchange(suppressed_, 0); }

private:
  [[nodiscard]] bool is_over(SteadyTime now) const noexcept { return now - began_ >= window_ns; }

  std::uint64_t most_lines_;
  SteadyTime began_;
  std::uint64_t lines_ = 0;
  std::uint64_t suppressed_ = 0;
};

}  // namespace sonopose::transitions
