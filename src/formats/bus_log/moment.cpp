#include "bus_log/moment.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace sonopose::bus_log {

namespace {

/// Returns the log time. `times`: those of the recording.
std::uint64_t log_time_of(const mcap::TimeSpan& times, const Moment& moment) {
  const auto* const after_s = std::get_if<double>(&moment);
  return after_s != nullptr ? times.after_start(*after_s) : std::get<std::uint64_t>(moment);
}

}  // namespace

std::string text_of(const Moment& moment) {
  const auto* const after_s = std::get_if<double>(&moment);
  return after_s != nullptr ? fmt::format("{} s", *after_s)
                            : fmt::format("log time {} ns", std::get<std::uint64_t>(moment));
}

mcap::TimeSpan part_of(const mcap::TimeSpan& times, const std::optional<Moment>& start,
                       const std::optional<Moment>& end) {
  mcap::TimeSpan part{0, std::numeric_limits<std::uint64_t>::max()};
  if (start) part.start_ns = log_time_of(times, *start);
  if (end) part.end_ns = log_time_of(times, *end);
  if (start && end && part.end_ns < part.start_ns) {
    throw std::invalid_argument(
        fmt::format("the end, {}, is before the start, {}", text_of(*end), text_of(*start)));
  }
  return part;
}

}  // namespace sonopose::bus_log
