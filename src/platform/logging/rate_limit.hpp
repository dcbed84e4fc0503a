#pragma once
/// \file
/// Bounds how often an event is logged.

#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <utility>

namespace sonopose::logging {

/// Admits some lines within a time window, and counts the others. Not thread-safe.
class RateLimit {
public:
  /// Two beginnings and two ends: a state that changes more often is flapping.
  static constexpr std::uint64_t default_max_lines = 4;
  static constexpr TimeNs window_ns = 60'000'000'000;

  explicit RateLimit(std::uint64_t max_lines = default_max_lines) noexcept : max_lines_(max_lines) {}

  /// Returns true if a line may be logged at `now`; otherwise counts it as suppressed.
  bool admits(SteadyTime now) noexcept {
    if (lines_ == 0 || is_over(now)) {
      began_ = now;
      lines_ = 0;
    }
    if (lines_ == max_lines_) {
      ++suppressed_;
      return false;
    }
    ++lines_;
    return true;
  }

  /// Returns true if suppressed lines were not taken yet.
  [[nodiscard]] bool has_suppressed() const noexcept { return suppressed_ > 0; }

  /// Returns true if lines were suppressed and the window is over.
  [[nodiscard]] bool report_due(SteadyTime now) const noexcept { return has_suppressed() && is_over(now); }

  /// Returns the number of lines suppressed since the last call.
  std::uint64_t take_suppressed() noexcept { return std::exchange(suppressed_, 0); }

private:
  [[nodiscard]] bool is_over(SteadyTime now) const noexcept { return now - began_ >= window_ns; }

  std::uint64_t max_lines_;
  SteadyTime began_;
  std::uint64_t lines_ = 0;
  std::uint64_t suppressed_ = 0;
};

}  // namespace sonopose::logging
