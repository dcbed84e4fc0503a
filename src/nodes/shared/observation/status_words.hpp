#pragma once
/// \file
/// Formats the status of a pose.

#include <cstdint>
#include <string>

namespace sonopose::observation {

/// Returns the bits of which a bit is a consequence; 0 if there are none. A frozen track is stale after a
/// while.
std::uint32_t causes_of(std::uint32_t bit);

/// Returns the bits that are no consequence of another.
std::uint32_t causes_in(std::uint32_t status);

/// "ok" if no bit is set, otherwise the names of its causes: "stale, low trust".
std::string status_words(std::uint32_t status);

}  // namespace sonopose::observation
