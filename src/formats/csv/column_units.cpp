#include "csv/column_units.hpp"

#include "csv/units.hpp"
#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace sonopose::csv {

namespace {

enum class Quantity : std::uint8_t { time, angle, rate, length, speed, acceleration, field, share, none };

struct Unit {
  Quantity quantity{};
  long double factor = 1;          ///< size in the first unit of the quantity
  std::string_view name;           ///< in messages
  std::string_view other_names{};  ///< separated by spaces; compared as `simplified` text
};

constexpr std::array known_units{
    Unit{Quantity::time, 1, "ns", "nanos"},
    Unit{Quantity::time, 1e3L, "us", "µs μs micros"},
    Unit{Quantity::time, 1e6L, "ms", "millis"},
    Unit{Quantity::time, 1e9L, "s"},
    Unit{Quantity::angle, 1, "deg", "° degree degrees"},
    Unit{Quantity::angle, 1 / degree, "rad", "radian radians"},
    Unit{Quantity::angle, 1e-3L / degree, "mrad"},
    Unit{Quantity::angle, 0.9L, "gon"},
    Unit{Quantity::rate, 1, "rad s^-1", "rad/s radps radians/s rad"},
    Unit{Quantity::rate, degree, "deg s^-1", "deg/s °/s °s-1 dps degps degrees/s deg"},
    Unit{Quantity::rate, 1e-3L, "mrad s^-1", "mrad/s"},
    Unit{Quantity::rate, 1e-3L * degree, "mdeg s^-1", "mdeg/s mdps"},
    Unit{Quantity::rate, 6 * degree, "rpm"},
    Unit{Quantity::length, 1, "m", "meter meters metre metres"},
    Unit{Quantity::length, 1e-2L, "cm"},
    Unit{Quantity::length, 1e-3L, "mm"},
    Unit{Quantity::length, 1e3L, "km"},
    Unit{Quantity::length, 0.3048L, "ft", "foot feet"},
    Unit{Quantity::length, 0.0254L, "inch", "inches"},
    Unit{Quantity::speed, 1, "m s^-1", "m/s mps"},
    Unit{Quantity::speed, 1e-2L, "cm s^-1", "cm/s"},
    Unit{Quantity::speed, 1e-3L, "mm s^-1", "mm/s"},
    Unit{Quantity::speed, 1 / 3.6L, "km h^-1", "km/h kmh kph"},
    Unit{Quantity::acceleration, 1, "m s^-2", "m/s2 m/s/s mps2 mpss"},
    Unit{Quantity::acceleration, 1e-2L, "cm s^-2", "cm/s2"},
    Unit{Quantity::acceleration, standard_gravity_mps2, "g", "G gee"},
    Unit{Quantity::acceleration, 1e-3L * standard_gravity_mps2, "mg", "mG"},
    Unit{Quantity::acceleration, 0.3048L, "ft s^-2", "ft/s2"},
    Unit{Quantity::field, 1, "uT", "µT μT ut"},
    Unit{Quantity::field, 1e-3L, "nT"},
    Unit{Quantity::field, 1e3L, "mT"},
    Unit{Quantity::field, 1e6L, "T"},
    Unit{Quantity::field, 1e2L, "G", "gauss Gauss"},
    Unit{Quantity::field, 1e-1L, "mG", "mgauss"},
    Unit{Quantity::share, 1, "%", "percent pct"},
    Unit{Quantity::share, 100, "1"},
    Unit{Quantity::none, 1, "", "1 -"},
};

/// A unit without spaces and signs of multiplication and power, with `s` for a second: `rads-1`, `m/s2`. At
/// the end of a name it is written `m_s2`.
std::string simplified(std::string_view unit) {
  std::string text;
  for (const char c : unit) {
    if (std::string_view(" ^*.()").find(c) == std::string_view::npos) text += c;
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> words{{{"_", "/"},
                                                                                {"seconds", "s"},
                                                                                {"second", "s"},
                                                                                {"sec", "s"},
                                                                                {"·", ""},
                                                                                {"⋅", ""},
                                                                                {"⁻", "-"},
                                                                                {"¹", "1"},
                                                                                {"²", "2"}}};
  for (const auto& [word, simple] : words) {
    if (const std::size_t at = text.find(word); at != std::string::npos)
      text.replace(at, word.size(), simple);
  }
  return text;
}

bool has_name(const Unit& unit, std::string_view simple_text) {
  if (simplified(unit.name) == simple_text) return true;
  std::string_view names = unit.other_names;
  while (!names.empty()) {
    const std::size_t space = std::min(names.find(' '), names.size());
    if (names.substr(0, space) == simple_text) return true;
    names.remove_prefix(std::min(space + 1, names.size()));
  }
  return false;
}

const Unit* find(std::string_view unit, std::optional<Quantity> quantity = {}) {
  const std::string text = simplified(unit);
  const auto* const found = std::find_if(known_units.begin(), known_units.end(), [&](const Unit& each) {
    return (!quantity || each.quantity == *quantity) && has_name(each, text);
  });
  return found == known_units.end() ? nullptr : found;
}

}  // namespace

std::optional<long double> unit_factor(std::string_view unit, std::string_view wanted) {
  const Unit* const to = find(wanted);
  const Unit* const from = to == nullptr ? nullptr : find(unit, to->quantity);
  if (from == nullptr) return std::nullopt;
  return from == to ? 1.0L : from->factor / to->factor;
}

bool is_unit(std::string_view unit) {
  return find(unit) != nullptr;
}

std::string units_like(std::string_view unit) {
  const Unit* const known = find(unit);
  std::string names;
  for (const Unit& each : known_units) {
    if (known == nullptr || each.quantity != known->quantity) continue;
    names += (names.empty() ? "" : ", ") + std::string(each.name.empty() ? "no unit" : each.name);
  }
  return names;
}

}  // namespace sonopose::csv
