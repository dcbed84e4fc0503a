#pragma once
/// \file
/// A change of state in words.

#include "logging/log.hpp"
#include "transitions/transition.hpp"

#include <string>

namespace sonopose::transitions {

struct Line {
  logging::Level level = logging::Level::info;
  std::string text;

  bool operator==(const Line&) const = default;
};

/// "beacon 7: stale: no valid fix for 1.0 s", with its level.
Line line_of(const Transition& transition);

}  // namespace sonopose::transitions
