#include <sonopose/text/size_text.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

namespace sonopose::text {
namespace {

constexpr std::string_view prefixes = "kmgtpe";
constexpr double decimal_step = 1000.0;
constexpr double binary_step = 1024.0;

/// Returns the bytes of a unit; empty if there is no such unit.
std::optional<double> unit_of(std::string_view text) {
  std::string unit;
  for (const char c : text) unit += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (unit.empty() || unit == "b") return 1.0;
  if (unit == "e") return std::nullopt;  // an exponent whose digits are missing
  const std::size_t prefix = prefixes.find(unit.front());
  const std::string_view rest = std::string_view(unit).substr(1);
  if (prefix == std::string_view::npos) return std::nullopt;
  const bool is_binary = rest == "i" || rest == "ib";
  if (!is_binary && !rest.empty() && rest != "b") return std::nullopt;
  return std::pow(is_binary ? binary_step : decimal_step, static_cast<double>(prefix + 1));
}

}  // namespace

std::optional<double> bytes_of(std::string_view text) {
  double number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  while (text.starts_with(' ')) text.remove_prefix(1);
  const auto unit = unit_of(text);
  if (!unit || !std::isfinite(number * *unit) || number < 0) return std::nullopt;
  return number * *unit;
}

std::string size_text(double bytes) {
  constexpr std::array<std::string_view, 7> units{" B", " kB", " MB", " GB", " TB", " PB", " EB"};
  std::size_t unit = 0;
  constexpr double rounded_up = 999.95;  // 1000 with four digits
  for (; bytes >= rounded_up && unit + 1 < units.size(); ++unit) bytes /= decimal_step;
  std::array<char, 32> digits{};
  constexpr int significant_digits = 4;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), bytes,
                                 std::chars_format::general, significant_digits)
                       .ptr;
  return std::string(digits.data(), end).append(units.at(unit));
}

}  // namespace sonopose::text
