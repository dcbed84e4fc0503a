#include "logging/bounded_log.hpp"

#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <utility>

namespace sonopose::logging {

BoundedLog::BoundedLog(std::uint64_t max_lines_per_minute)
    : BoundedLog(max_lines_per_minute,
                 [](Level level, const std::string& text) { logging::write(level, text); }) {}

BoundedLog::BoundedLog(std::uint64_t max_lines_per_minute, Write write)
    : write_(std::move(write)), limit_(max_lines_per_minute) {}

void BoundedLog::write(Level level, std::string text, SteadyTime now) {
  update(now);
  if (limit_.admits(now)) return write_(level, text);
  level_ = level;
  latest_ = std::move(text);
}

void BoundedLog::update(SteadyTime now) {
  if (!limit_.report_due(now)) return;
  finish();
  limit_.admits(now);
}

void BoundedLog::finish() {
  if (!limit_.has_suppressed()) return;
  const std::uint64_t others = limit_.take_suppressed() - 1;
  if (others == 0) return write_(level_, latest_);
  write_(level_,
         fmt::format("{} ({} not logged)", latest_, text::count_text(others, "line was", "lines were")));
}

}  // namespace sonopose::logging
