#include "moment_option.hpp"

#include "clocks/utc_time.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <string>
#include <system_error>

namespace sonopose::apps {
namespace {

using bus_log::Moment;

/// Limit above which a number is a log time in ns: 285 years are longer than any recording.
constexpr double max_after_s = 9e9;

std::optional<Moment> moment_of(const std::string& text) {
  if (const auto time_ns = clocks::utc_time_ns(text)) return static_cast<std::uint64_t>(*time_ns);
  const char* const end = text.data() + text.size();
  double after_s = 0;
  const auto number = std::from_chars(text.data(), end, after_s);
  if (number.ec != std::errc() || number.ptr != end || !(after_s >= 0)) return std::nullopt;
  if (after_s <= max_after_s) return after_s;
  std::uint64_t time_ns = 0;
  const auto integer = std::from_chars(text.data(), end, time_ns);
  if (integer.ec != std::errc() || integer.ptr != end) return std::nullopt;
  return time_ns;
}

void add(CommandLine& app, const char* name, std::optional<Moment>& moment, const char* description) {
  const Check is_moment{
      [](const std::string& text) {
        if (moment_of(text)) return std::string();
        return fmt::format(
            "'{}' is neither a number of seconds after the first message, nor a UTC time such as "
            "2026-01-31T12:00:00.5, nor a log time in ns",
            text);
      },
      ""};
  app.add_option_function<std::string>(
         name, [&moment](const std::string& text) { moment = moment_of(text); }, description)
      .check(is_moment)
      .type_name("TIME");
}

}  // namespace

void add_span_options(CommandLine& app, std::optional<Moment>& start, std::optional<Moment>& end) {
  add(app, "--start", start,
      "From this time on: seconds after the first message, a UTC time or a log time in ns");
  add(app, "--end", end, "To this time");
}

}  // namespace sonopose::apps
