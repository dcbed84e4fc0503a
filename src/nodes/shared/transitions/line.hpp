#pragma once
/// \file
/// Describes a change of state in words.

#include "logging/log.hpp"
#include "transitions/transition.hpp"

#include <string>
#include <string_view>

namespace sonopose::transitions {

struct LogText {
  logging::Level level = logging::Level::info;
  std::string text;

  bool operator==(const LogText&) const = default;
};

/// Returns a line such as "beacon 7: stale: no valid fix for 1.0 s", with its level.
LogText line_of(const Transition& transition);

/// Returns the part of such a line that names the change, without reasons and figures: "beacon 7: stale". Two
/// processes that see the same change measure slightly different figures.
std::string_view change_of(std::string_view line_text);

}  // namespace sonopose::transitions
