#pragma once
/// \file
/// Times at which a part of a recording begins or ends.

#include "mcap/records.hpp"
#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>

namespace sonopose::bus_log {

/// Seconds after the first message of the recording, or a log time in ns.
using Moment = std::variant<double, std::uint64_t>;

/// Returns a recorded time, limited to the range of TimeNs: a file can have any value.
inline TimeNs time_of(std::uint64_t log_time_ns) {
  return static_cast<TimeNs>(std::min<std::uint64_t>(log_time_ns, std::numeric_limits<TimeNs>::max()));
}

/// Returns "5 s" or "log time 5000 ns".
std::string text_of(const Moment& moment);

/// The log times of a part of a recording with these `times`; without start or end, its bound is that of the
/// type. Throws std::invalid_argument if the end is before the start.
mcap::TimeSpan part_of(const mcap::TimeSpan& times, const std::optional<Moment>& start,
                       const std::optional<Moment>& end);

}  // namespace sonopose::bus_log
