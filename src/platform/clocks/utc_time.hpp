#pragma once
/// \file
/// Reads a date and time.

#include <cstdint>
#include <optional>
#include <string_view>

namespace sonopose::clocks {

/// Returns the nanoseconds since 1970 of "2026-01-31 12:00:00.123 UTC" or "31.01.2026 12:00", also with T and
/// Z, and with a zone such as +01:00. Without a zone it is UTC. Empty for other texts, and outside of the
/// years 1970 … 2100.
std::optional<std::int64_t> utc_time_ns(std::string_view text);

}  // namespace sonopose::clocks
