#pragma once
/// \file
/// Numbers that stand in log files in another unit than in memory (degrees, µT). Private to this room.
///
/// A double of degrees cannot name every double of radians: its steps are up to 1.8 times too coarse. A cell
/// that is longer than a short number is therefore read with the precision of a long double, and the writer
/// uses so many digits where fewer would not come back to the same bits.

#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::files {

inline constexpr long double degree = std::numbers::pi_v<long double> / 180.0L;
inline constexpr long double microtesla = 1e-6L;

/// The number in the text; empty where the text is anything else.
std::optional<double> parse_number(std::string_view text);

/// The number in the text times `unit`; empty where the text is anything else.
std::optional<double> parse_number_in(long double unit, std::string_view text);

/// The shortest text that parse_number reads back to the same bits.
void append_number(std::string& text, double value);

/// A text that parse_number_in reads back to the same bits.
void append_number_in(long double unit, std::string& text, double value);

}  // namespace sonopose::files
