#pragma once
/// \file
/// Our levels as those of spdlog.

#include "logging/log.hpp"

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

}  // namespace sonopose::logging
