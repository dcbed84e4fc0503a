#pragma once
/// \file
/// The page's events: a change of state, or a line of a log.

#include "logging/log.hpp"
#include <sonopose/samples/log_line.hpp>

#include <nlohmann/json.hpp>

#include <string_view>

namespace sonopose::web::live {

/// "info", "warning" or "error", as the page has it.
inline std::string_view word_of(logging::Level level) {
  if (level <= logging::Level::info) return "info";
  return level == logging::Level::warning ? "warning" : "error";
}
inline std::string_view word_of(LogLevel level) {
  if (level <= LogLevel::info) return "info";
  return level == LogLevel::warning ? "warning" : "error";
}

/// {"t", "level", "text"}; t in seconds since the Unix epoch.
inline nlohmann::json event_json(TimeNs time_ns, std::string_view level, std::string_view text) {
  return {{"t", 1e-9 * static_cast<double>(time_ns)}, {"level", level}, {"text", text}};
}

/// The same with "program", "host" and "pid".
inline nlohmann::json event_json(const LogLine& line) {
  nlohmann::json event = event_json(line.time_ns, word_of(line.level), line.text);
  event["program"] = line.program;
  event["host"] = line.host;
  event["pid"] = line.process_id;
  return event;
}

}  // namespace sonopose::web::live
