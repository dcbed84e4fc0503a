#pragma once
/// \file
/// A rate-limited log of one changing state.

#include "logging/log.hpp"
#include "transitions/rate_limit.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace sonopose::transitions {

/// Logs a limited number of changes per minute. Counts the others, and logs the latest of them at the end of
/// the minute or of the log. Not thread-safe.
class BoundedLog {
public:
  using Write = std::function<void(logging::Level, const std::string&)>;

  explicit BoundedLog(
      std::uint64_t max_lines_per_minute,
      Write write = [](logging::Level level, const std::string& text) { logging::write(level, text); })
      : write_(std::move(write)), limit_(max_lines_per_minute) {}

  void write(logging::Level level, std::string text, SteadyTime now) {
    update(now);
    if (limit_.admits(now)) return write_(level, text);
    level_ = level;
    latest_ = std::move(text);
  }

  /// Logs pending changes that are due. Call it several times a second.
  void update(SteadyTime now) {
    if (!limit_.report_due(now)) return;
    finish();
    limit_.admits(now);
  }

  /// Returns true if `update` will have something to log.
  [[nodiscard]] bool has_pending() const { return limit_.has_suppressed(); }

  /// Logs pending changes. Call it at the end.
  void finish() {
    if (!limit_.has_suppressed()) return;
    const std::uint64_t others = limit_.take_suppressed() - 1;
    if (others == 0) return write_(level_, latest_);
    write_(level_,
           fmt::format("{} ({} not logged)", latest_, text::count_text(others, "line was", "lines were")));
  }

private:
  Write write_;
  RateLimit limit_;
  logging::Level level_ = logging::Level::info;
  std::string latest_;
};

}  // namespace sonopose::transitions
