#pragma once
/// \file
/// Requests of the page to its server: texts of the sub-protocol sonopose.v1 (page_messages.hpp). `op` is
/// change (id, address or "all", assignments: texts by key), reset (id, address) or examine (seconds).

#include <sonopose/samples/live_settings.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace sonopose::web {

/// Changes settings, or resets estimators if there are no assignments.
struct ChangeRequest {
  std::uint64_t id = 0;  ///< chosen by the page
  bool is_reset = false;
  SettingsRequest settings;  ///< only the address for a reset
};
/// Runs the doctor.
struct ExamineRequest {
  double seconds = 8;
};
/// A malformed request: its id and the reason.
struct RefusedRequest {
  std::uint64_t id = 0;
  std::string reason;
};
using PageRequest = std::variant<ChangeRequest, ExamineRequest, RefusedRequest>;

/// Parses a request. Never throws for a page's input.
PageRequest parse_page_request(std::string_view text);

}  // namespace sonopose::web
