#pragma once
/// \file
/// Reads and writes numbers that log files store in another unit (degrees, µT).
///
/// A double of degrees cannot represent every double of radians: its steps are up to 1.8 times too coarse.
/// Long cells are therefore read as long double, and the writer uses that many digits if fewer do not read
/// back to the same bits.

#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::csv {

inline constexpr long double degree = std::numbers::pi_v<long double> / 180.0L;
inline constexpr long double microtesla = 1e-6L;

/// Returns the number in the text; empty if the text is not a number.
std::optional<double> parse_number(std::string_view text);

/// Returns the number, precise enough for seconds since 1970 with nanoseconds; empty if the text is not a
/// number.
std::optional<long double> parse_long_number(std::string_view text);

/// Returns the number in the text times `unit`; empty if the text is not a number.
std::optional<double> parse_number_in(long double unit, std::string_view text);

/// Appends the shortest text that parse_number reads back to the same bits.
void append_number(std::string& text, double value);

/// Appends a text that parse_number_in reads back to the same bits.
void append_number_in(long double unit, std::string& text, double value);

}  // namespace sonopose::csv
