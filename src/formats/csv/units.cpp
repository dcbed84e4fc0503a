#include "csv/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace sonopose::csv {

namespace {

constexpr std::size_t short_cell = 17;  ///< characters; longer cells are read as long double
constexpr int long_digits = 20;         ///< digits after the first: 21 in all represent every 64-bit mantissa

template <class Number>
std::optional<Number> parse(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Number value = 0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc{} || result.ptr != end) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  return parse<double>(text);
}

std::optional<long double> parse_long_number(std::string_view text) {
  return parse<long double>(text);
}

std::optional<double> parse_number_in(long double unit, std::string_view text) {
  if (text.size() <= short_cell) {
    const auto value = parse<double>(text);
    return value ? std::optional(*value * static_cast<double>(unit)) : std::nullopt;
  }
  const auto value = parse_long_number(text);
  return value ? std::optional(static_cast<double>(*value * unit)) : std::nullopt;
}

void append_number(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto result = std::to_chars(digits.begin(), digits.end(), value);
  text.append(digits.data(), result.ptr);
}

void append_number_in(long double unit, std::string& text, double value) {
  const long double scaled = value / unit;
  const std::size_t before = text.size();
  append_number(text, static_cast<double>(scaled));
  if (!std::isfinite(value) || parse_number_in(unit, std::string_view(text).substr(before)) == value) return;
  text.resize(before);
  std::array<char, 48> digits{};
  const auto result =
      std::to_chars(digits.begin(), digits.end(), scaled, std::chars_format::scientific, long_digits);
  text.append(digits.data(), result.ptr);
}

}  // namespace sonopose::csv
