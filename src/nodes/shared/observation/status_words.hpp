#pragma once
/// \file
/// Formats the status of a pose.

#include <cstdint>
#include <string>

namespace sonopose::observation {

/// "ok" if no bit is set, otherwise the names of the set bits: "stale, frozen track".
std::string status_words(std::uint32_t status);

}  // namespace sonopose::observation
