#pragma once
/// \file
/// Converts levels to those of spdlog, and marks entries of its queues that are not lines.

#include "logging/log.hpp"

#include <array>
#include <cstdint>
#include <spdlog/common.h>

namespace sonopose::logging {

inline spdlog::level::level_enum spdlog_level(Level level) {
  switch (level) {
    case Level::debug:
      return spdlog::level::debug;
    case Level::info:
      return spdlog::level::info;
    case Level::warning:
      return spdlog::level::warn;
    case Level::error:
      return spdlog::level::err;
    case Level::failure:
      return spdlog::level::critical;
  }
  return spdlog::level::critical;
}

inline Level level_of(spdlog::level::level_enum level) {
  if (level <= spdlog::level::debug) return Level::debug;
  if (level == spdlog::level::info) return Level::info;
  if (level == spdlog::level::warn) return Level::warning;
  return level == spdlog::level::err ? Level::error : Level::failure;
}

/// A number that keeps its place among the lines of a queue. Entries of a `kind` defined here have no text.
template <std::size_t size>
spdlog::source_loc mark(const std::array<char, size>& kind, std::uint32_t number) {
  return {kind.data(), static_cast<int>(number), ""};
}
template <std::size_t size>
bool is_mark(const spdlog::source_loc& source, const std::array<char, size>& kind) {
  return source.filename == kind.data();
}
inline std::uint32_t number_of(const spdlog::source_loc& mark) {
  return static_cast<std::uint32_t>(mark.line);
}
inline constexpr std::array call_mark = std::to_array("call");
inline constexpr std::array flush_mark = std::to_array("flush");

}  // namespace sonopose::logging
