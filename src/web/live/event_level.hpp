#pragma once
/// \file
/// The levels of the page's events.

#include "logging/log.hpp"

#include <string_view>

namespace sonopose::web::live {

/// "info", "warning" or "error", as the page has it.
inline std::string_view word_of(logging::Level level) {
  if (level <= logging::Level::info) return "info";
  return level == logging::Level::warning ? "warning" : "error";
}

}  // namespace sonopose::web::live
