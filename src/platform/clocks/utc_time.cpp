#include "clocks/utc_time.hpp"

#include <charconv>
#include <chrono>
#include <system_error>

namespace sonopose::clocks {
namespace {

/// Reads the parts of a text from left to right. Members return false if the text continues otherwise.
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
  bool take_fraction(std::int64_t& fraction_ns) {
    std::int64_t unit_ns = 1'000'000'000;
    for (unsigned digit = 0; unit_ns > 1 && take(1, digit);) fraction_ns += digit * (unit_ns /= 10);
    return unit_ns < 1'000'000'000;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

private:
  std::string_view rest_;
};

/// Takes "Z", " UTC", "+01:00" or nothing. Returns how far the zone is ahead of UTC.
std::optional<std::chrono::minutes> take_zone(Parts& parts) {
  using namespace std::chrono;
  if (parts.rest().empty() || parts.rest() == "Z" || parts.rest() == " UTC") return minutes{0};
  const bool is_ahead = parts.take('+');
  if (!is_ahead && !parts.take('-')) return std::nullopt;
  unsigned hour = 0;
  unsigned minute = 0;
  if (!parts.take(2, hour) || hour > 14) return std::nullopt;
  parts.take(':');
  if (!parts.take(2, minute) || minute > 59 || !parts.rest().empty()) return std::nullopt;
  const minutes offset = hours(hour) + minutes(minute);
  return is_ahead ? offset : -offset;
}

}  // namespace

std::optional<std::int64_t> utc_time_ns(std::string_view text) {
  using namespace std::chrono;
  Parts parts(text);
  unsigned year_number = 0;
  unsigned month_number = 0;
  unsigned day_number = 0;
  unsigned hour = 0;
  unsigned minute = 0;
  unsigned second = 0;
  std::int64_t fraction_ns = 0;
  const bool is_day_first = text.find('.') == 2;  // 31.01.2026
  const bool has_day = is_day_first
                           ? parts.take(2, day_number) && parts.take('.') && parts.take(2, month_number) &&
                                 parts.take('.') && parts.take(4, year_number)
                           : parts.take(4, year_number) && parts.take('-') && parts.take(2, month_number) &&
                                 parts.take('-') && parts.take(2, day_number);
  const bool has_time = has_day && (parts.take('T') || parts.take(' ')) && parts.take(2, hour) &&
                        parts.take(':') && parts.take(2, minute);
  if (!has_time) return std::nullopt;
  if (parts.take(':') && !parts.take(2, second)) return std::nullopt;
  if (parts.take('.') && !parts.take_fraction(fraction_ns)) return std::nullopt;
  const auto zone = take_zone(parts);
  if (!zone) return std::nullopt;
  const year_month_day date{year(static_cast<int>(year_number)), month(month_number), day(day_number)};
  if (!date.ok() || year_number < 1970 || year_number > 2100) return std::nullopt;
  if (hour > 23 || minute > 59 || second > 59) return std::nullopt;
  const seconds since_epoch =
      sys_days(date).time_since_epoch() + hours(hour) + minutes(minute) + seconds(second) - *zone;
  if (since_epoch.count() < 0) return std::nullopt;
  return nanoseconds(since_epoch).count() + fraction_ns;
}

}  // namespace sonopose::clocks
