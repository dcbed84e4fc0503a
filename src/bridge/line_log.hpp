#pragma once
/// \file
/// The log of one line, bounded: a device that comes and goes would fill it.

#include "logging/log.hpp"
#include "transitions/rate_limit.hpp"

#include <fmt/format.h>

#include <functional>
#include <string>
#include <utility>

namespace sonopose::bridge {

/// Logs some changes a minute. What is left out is counted, and its latest is logged when the minute is over
/// or the line ends. Not thread-safe.
class LineLog {
public:
  using Write = std::function<void(logging::Level, const std::string&)>;

  explicit LineLog(Write write = [](logging::Level level,
                                    const std::string& text) { logging::write(level, text); })
      : write_(std::move(write)) {}

  void write(logging::Level level, std::string text, SteadyTime now) {
    update(now);
    if (limit_.admits(now)) return write_(level, text);
    level_ = level;
    latest_ = std::move(text);
  }

  /// Call it several times a second.
  void update(SteadyTime now) {
    if (!limit_.owes_report(now)) return;
    finish();
    limit_.admits(now);
  }

  /// The line ends.
  void finish() {
    if (!limit_.has_suppressed()) return;
    write_(level_, fmt::format("{} ({} changes were not logged)", latest_, limit_.take_suppressed()));
  }

private:
  static constexpr std::uint64_t most_lines = 8;

  Write write_;
  transitions::RateLimit limit_{most_lines};
  logging::Level level_ = logging::Level::info;
  std::string latest_;
};

}  // namespace sonopose::bridge
