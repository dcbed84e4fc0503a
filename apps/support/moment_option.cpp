#include "moment_option.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace sonopose::apps {
namespace {

using bus_log::Moment;

/// Above, a number is a log time in ns: 285 years are longer than any recording.
constexpr double max_after_s = 9e9;

/// Reads the parts of a text from left to right. Members return false if the text goes on otherwise.
class Parts {
public:
  explicit Parts(std::string_view text) : rest_(text) {}

  bool take(char expected) {
    if (rest_.empty() || rest_.front() != expected) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool take(std::size_t digits, unsigned& value) {
    if (rest_.size() < digits) return false;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + digits, value);
    if (error != std::errc() || end != rest_.data() + digits) return false;
    rest_.remove_prefix(digits);
    return true;
  }
  bool take_fraction(std::uint64_t& fraction_ns) {
    std::uint64_t unit_ns = 1'000'000'000;
    for (unsigned digit = 0; unit_ns > 1 && take(1, digit);) fraction_ns += digit * (unit_ns /= 10);
    return unit_ns < 1'000'000'000;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

private:
  std::string_view rest_;
};

/// Reads "2026-01-31 12:00:00.123 UTC", also with T and Z, without seconds and without the zone.
std::optional<std::uint64_t> utc_time_ns(std::string_view text) {
  using namespace std::chrono;
  Parts parts(text);
  unsigned year_number = 0;
  unsigned month_number = 0;
  unsigned day_number = 0;
  unsigned hour = 0;
  unsigned minute = 0;
  unsigned second = 0;
  std::uint64_t fraction_ns = 0;
  const bool has_day = parts.take(4, year_number) && parts.take('-') && parts.take(2, month_number) &&
                       parts.take('-') && parts.take(2, day_number);
  const bool has_time = has_day && (parts.take('T') || parts.take(' ')) && parts.take(2, hour) &&
                        parts.take(':') && parts.take(2, minute);
  if (!has_time) return std::nullopt;
  if (parts.take(':') && !parts.take(2, second)) return std::nullopt;
  if (parts.take('.') && !parts.take_fraction(fraction_ns)) return std::nullopt;
  if (!parts.rest().empty() && parts.rest() != "Z" && parts.rest() != " UTC") return std::nullopt;
  const year_month_day date{year(static_cast<int>(year_number)), month(month_number), day(day_number)};
  if (!date.ok() || year_number < 1970 || year_number > 2500) return std::nullopt;
  if (hour > 23 || minute > 59 || second > 59) return std::nullopt;
  const seconds since_epoch =
      sys_days(date).time_since_epoch() + hours(hour) + minutes(minute) + seconds(second);
  return static_cast<std::uint64_t>(since_epoch.count()) * 1'000'000'000 + fraction_ns;
}

std::optional<Moment> moment_of(const std::string& text) {
  if (const auto time_ns = utc_time_ns(text)) return *time_ns;
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

void add(CLI::App& app, const char* name, std::optional<Moment>& moment, const char* description) {
  const CLI::Validator is_moment{
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
      ->check(is_moment)
      ->type_name("TIME");
}

}  // namespace

void add_span_options(CLI::App& app, std::optional<Moment>& start, std::optional<Moment>& end) {
  add(app, "--start", start,
      "From this time on: seconds after the first message, a UTC time or a log time in ns");
  add(app, "--end", end, "To this time");
}

}  // namespace sonopose::apps
