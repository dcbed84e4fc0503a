#pragma once
/// \file
/// A rate-limited log of one changing state.

#include "logging/log.hpp"
#include "logging/rate_limit.hpp"

#include <cstdint>
#include <functional>
#include <string>

namespace sonopose::logging {

/// Logs a limited number of changes per minute. Counts the others, and logs the latest of them at the end of
/// the minute or of the log. Not thread-safe.
class BoundedLog {
public:
  using Write = std::function<void(Level, const std::string&)>;

  /// Writes to the log of the process.
  explicit BoundedLog(std::uint64_t max_lines_per_minute);
  BoundedLog(std::uint64_t max_lines_per_minute, Write write);

  void write(Level level, std::string text, SteadyTime now);

  /// Logs pending changes that are due. Call it several times a second.
  void update(SteadyTime now);

  /// Returns true if `update` will have something to log.
  [[nodiscard]] bool has_pending() const { return limit_.has_suppressed(); }

  /// Logs pending changes. Call it at the end.
  void finish();

private:
  Write write_;
  RateLimit limit_;
  Level level_ = Level::info;
  std::string latest_;
};

}  // namespace sonopose::logging
