#pragma once
/// \file
/// Times at which a part of a recording begins or ends.

#include "mcap/records.hpp"
#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <variant>

namespace sonopose::bus_log {

/// Seconds after the first message of the recording, or a log time in ns.
using Moment = std::variant<double, std::uint64_t>;

/// Returns a recorded time, limited to the range of TimeNs: a file can have any value.
inline TimeNs time_of(std::uint64_t log_time_ns) {
  return static_cast<TimeNs>(std::min<std::uint64_t>(log_time_ns, std::numeric_limits<TimeNs>::max()));
}

/// Returns the log time. `times`: those of the recording.
inline std::uint64_t log_time_of(const mcap::TimeSpan& times, const Moment& moment) {
  const auto* const after_s = std::get_if<double>(&moment);
  return after_s != nullptr ? times.after_start(*after_s) : std::get<std::uint64_t>(moment);
}

}  // namespace sonopose::bus_log
