#pragma once
/// \file
/// Words and numbers that the table, the summary and the screen have in common.

#include "observation/stream_state.hpp"

#include <string>
#include <string_view>

namespace sonopose::monitor {

/// The yaw, -180…180.
double heading_deg(const FusedPose& pose);

/// Shown for a value that is not known.
inline constexpr std::string_view unknown = "–";

/// A number with this many decimals; `unknown` if it is not finite.
std::string number(double value, int decimals);

/// Milliseconds to two decimal places, `unknown` if not known.
std::string ms(double seconds);

std::string_view role_word(FusionRole role);

using observation::stream_words;

/// The problem counters of one beacon, a line for each process with at least one. Each line ends with a
/// newline.
std::string problems_of(const observation::BeaconView& view);

}  // namespace sonopose::monitor
