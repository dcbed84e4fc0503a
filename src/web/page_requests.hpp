#pragma once
/// \file
/// What the page asks of its server: texts of the sub-protocol sonopose.v1 (docs/web.md).

#include <sonopose/samples/live_settings.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace sonopose::web {

/// Change settings, or reset estimators if there are no assignments.
struct ChangeRequest {
  std::uint64_t id = 0;  ///< chosen by the page
  bool is_reset = false;
  SettingsRequest settings;  ///< of a reset: the address alone
};
/// Run the doctor.
struct ExamineRequest {
  double seconds = 8;
};
/// What cannot be read: why, and to which id.
struct RefusedRequest {
  std::uint64_t id = 0;
  std::string reason;
};
using PageRequest = std::variant<ChangeRequest, ExamineRequest, RefusedRequest>;

/// Never throws for what a page sends.
PageRequest parse_page_request(std::string_view text);

}  // namespace sonopose::web
