#pragma once
/// \file
/// Words and numbers shared by the table, the summary and the screen.

#include "observation/stream_state.hpp"

#include <string>
#include <string_view>

namespace sonopose::monitor {

/// Yaw in degrees, -180…180.
double heading_deg(const FusedPose& pose);

/// Placeholder for an unknown value.
inline constexpr std::string_view unknown = "–";

/// A number with this many decimals; `unknown` if not finite.
std::string number(double value, int decimals);

/// Milliseconds with two decimals; `unknown` if not known.
std::string ms(double seconds);

std::string_view role_word(FusionRole role);

using observation::stream_words;

/// Problem counters of one beacon: one line for each process that has any. Each line ends with a newline.
std::string problems_of(const observation::BeaconView& view);

}  // namespace sonopose::monitor
