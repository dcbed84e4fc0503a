#include "marvelmind/dashboard_line.hpp"

#include <charconv>
#include <cmath>
#include <limits>

namespace sonopose::marvelmind {

namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;

/// Returns the days since 1970-01-01 in the Gregorian calendar.
constexpr std::int64_t days_to(std::int64_t year, std::int64_t month, std::int64_t day) {
  // Years begin in March here, so that the leap day is the last one.
  const std::int64_t shifted_year = month > 2 ? year : year - 1;
  const std::int64_t shifted_month = (month + 9) % 12;
  const std::int64_t day_of_year = (153 * shifted_month + 2) / 5 + day - 1;
  constexpr std::int64_t days_before_1970 = 719'468;
  return 365 * shifted_year + shifted_year / 4 - shifted_year / 100 + shifted_year / 400 + day_of_year -
         days_before_1970;
}
static_assert(days_to(1970, 1, 1) == 0);
static_assert(days_to(2000, 3, 1) == 11'017);

/// The cells of a line from left to right. After the first wrong one, all are empty.
class Cells {
public:
  explicit Cells(std::string_view line) : rest_{line} {}

  std::string_view next() {
    const std::size_t comma = rest_.find(',');
    const std::string_view cell = rest_.substr(0, comma);
    rest_ = comma == std::string_view::npos ? std::string_view() : rest_.substr(comma + 1);
    return cell;
  }

  template <class Number>
  Number number(std::string_view name, Number min = std::numeric_limits<Number>::lowest(),
                Number max = std::numeric_limits<Number>::max()) {
    const std::string_view cell = next();
    Number value{};
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    const bool is_good =
        error == std::errc() && end == cell.data() + cell.size() && value >= min && value <= max;
    if (!is_good && problem_.empty()) problem_ = name;
    return is_good ? value : Number{};
  }

  /// Returns empty if the value is not applicable or not licensed.
  template <class Number>
  std::optional<Number> optional(std::string_view name) {
    if (rest_.starts_with("na") || rest_.starts_with("nl")) {
      next();
      return std::nullopt;
    }
    return number<Number>(name);
  }

  [[nodiscard]] std::string_view problem() const { return problem_; }

private:
  std::string_view rest_;
  std::string_view problem_;
};

/// Parses "T2026_01_31__235959_999"; empty for any other form.
std::optional<TimeNs> parse_time(std::string_view text) {
  constexpr std::string_view form = "Tdddd_dd_dd__dddddd_ddd";
  if (text.size() != form.size()) return std::nullopt;
  for (std::size_t i = 0; i < form.size(); ++i) {
    const bool is_digit = text[i] >= '0' && text[i] <= '9';
    if (form[i] == 'd' ? !is_digit : text[i] != form[i]) return std::nullopt;
  }
  const auto digits = [text](std::size_t at, std::size_t count) {
    std::int64_t value = 0;
    for (const char digit : text.substr(at, count)) value = 10 * value + (digit - '0');
    return value;
  };
  const std::int64_t year = digits(1, 4);
  const std::int64_t month = digits(6, 2);
  const std::int64_t day = digits(9, 2);
  const bool is_date = year >= 1971 && year <= 2100 && month >= 1 && month <= 12 && day >= 1 &&
                       day <= days_to(year + month / 12, month % 12 + 1, 1) - days_to(year, month, 1);
  const bool is_time = digits(13, 2) < 24 && digits(15, 2) < 60 && digits(17, 2) <= 60;
  if (!is_date || !is_time) return std::nullopt;
  const std::int64_t seconds =
      86'400 * days_to(year, month, day) + 3'600 * digits(13, 2) + 60 * digits(15, 2) + digits(17, 2);
  return seconds * ns_per_s + digits(20, 3) * ns_per_ms;
}

Position position_in(Cells& cells, std::int64_t sent_ms) {
  constexpr double mm_per_m = 1000.0;
  constexpr double max_m = 1e6;  // fits into 32 bits of millimetres
  Position position;
  position.address = cells.number<std::uint8_t>("address");
  for (std::int32_t& mm : position.xyz_mm) {
    mm = static_cast<std::int32_t>(std::lround(cells.number<double>("x, y, z", -max_m, max_m) * mm_per_m));
  }
  position.flags = cells.number<std::uint8_t>("flags");
  position.angle.word = cells.optional<std::uint16_t>("angle").value_or(PairAngle::not_applicable);
  position.time_passed_ms = cells.optional<std::uint16_t>("time passed").value_or(0);
  position.time = {TimeBase::unix_ms, sent_ms - position.time_passed_ms};
  return position;
}

RawImu imu_in(Cells& cells, std::int64_t sent_ms) {
  RawImu imu;
  imu.address = cells.number<std::uint8_t>("address");
  const auto read = [&cells](Vector3i16& vector, std::string_view name) {
    bool is_available = true;
    for (std::int16_t& component : vector) {
      const auto value = cells.optional<std::int16_t>(name);
      is_available = is_available && value;
      component = value.value_or(0);
    }
    return is_available;
  };
  if (!read(imu.accel, "accelerometer")) imu.flags |= imu_accel_not_available;
  if (!read(imu.gyro, "gyroscope")) imu.flags |= imu_gyro_not_available;
  if (!read(imu.compass, "compass")) imu.flags |= imu_compass_not_available;
  imu.time = {TimeBase::unix_ms, sent_ms};
  return imu;
}

Quality quality_in(Cells& cells) {
  Quality quality;
  quality.address = cells.number<std::uint8_t>("address");
  quality.quality_percent = cells.number<std::uint8_t>("quality", 0, 100);
  quality.geofence_zone = cells.optional<std::uint8_t>("zone").value_or(0);
  return quality;
}

}  // namespace

DashboardLine parse_dashboard_line(std::string_view line) {
  using Kind = DashboardLine::Kind;
  Cells cells(line);
  DashboardLine parsed;
  const auto time_ns = parse_time(cells.next());
  if (!time_ns) return {Kind::invalid, 0, {}, "time"};
  parsed.time_ns = *time_ns;
  cells.next();  // skips the user
  if (cells.next() != "41") return parsed;
  const std::string_view code = cells.next();
  const std::int64_t sent_ms = *time_ns / ns_per_ms;
  if (code == "17" || code == "129") {
    parsed.packet = position_in(cells, sent_ms);
  } else if (code == "3" || code == "131") {
    parsed.packet = imu_in(cells, sent_ms);
  } else if (code == "7") {
    parsed.packet = quality_in(cells);
  } else {
    return parsed;
  }
  parsed.kind = cells.problem().empty() ? Kind::packet : Kind::invalid;
  parsed.problem = cells.problem();
  return parsed;
}

}  // namespace sonopose::marvelmind
