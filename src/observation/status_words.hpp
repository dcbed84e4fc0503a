#pragma once
/// \file
/// The status of a pose in words.

#include <cstdint>
#include <string>

namespace sonopose::observation {

/// "ok", or the names of the status bits, as "stale, frozen track".
std::string status_words(std::uint32_t status);

}  // namespace sonopose::observation
