#pragma once
/// \file
/// Times at which a part of a recording begins or ends.

#include "mcap/records.hpp"

#include <cstdint>
#include <variant>

namespace sonopose::bus_log {

/// Seconds after the first message of the recording, or a log time in ns.
using Moment = std::variant<double, std::uint64_t>;

/// Returns the log time. `times`: those of the recording.
inline std::uint64_t log_time_of(const mcap::TimeSpan& times, const Moment& moment) {
  const auto* const after_s = std::get_if<double>(&moment);
  return after_s != nullptr ? times.after_start(*after_s) : std::get<std::uint64_t>(moment);
}

}  // namespace sonopose::bus_log
