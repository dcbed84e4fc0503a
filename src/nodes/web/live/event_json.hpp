#pragma once
/// \file
/// The page's events: a change of state, or a line of a log.

#include "logging/log.hpp"
#include <sonopose/samples/log_line.hpp>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sonopose::web::live {

inline constexpr std::size_t max_events = 500;  ///< most events that the page shows, the latest

/// "info", "warning" or "error", as on the page. `Level`: logging::Level or LogLevel.
template <class Level>
std::string_view word_of(Level level) {
  if (level <= Level::info) return "info";
  return level == Level::warning ? "warning" : "error";
}

/// True if the line is from a fusion, which logs the changes of state of its beacons.
inline bool is_of_fusion(const LogLine& line) {
  return line.program == "sonopose-fusion";
}

/// {"t", "level", "text"}; t in seconds since the Unix epoch.
inline nlohmann::json event_json(TimeNs time_ns, std::string_view level, std::string_view text) {
  return {{"t", 1e-9 * static_cast<double>(time_ns)}, {"level", level}, {"text", text}};
}

/// Adds "program", "host" and "pid", and "missing" if lines of the process are missing before this one.
inline nlohmann::json event_json(const LogLine& line, std::uint64_t missing) {
  nlohmann::json event = event_json(line.time_ns, word_of(line.level), line.text);
  event["program"] = line.program;
  event["host"] = line.host;
  event["pid"] = line.process_id;
  if (missing > 0) event["missing"] = missing;
  return event;
}

}  // namespace sonopose::web::live
