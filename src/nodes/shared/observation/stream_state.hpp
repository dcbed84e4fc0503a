#pragma once
/// \file
/// State of a beacon's pose stream: words and severity.

#include "observation/beacon_observer.hpp"

#include <string>
#include <string_view>

namespace sonopose::observation {

/// True if its bridge detects another one that publishes it.
bool has_several_bridges(const BeaconView& view);

/// "IMU upside down" or "IMU on its side" if its mount differs from the settings, or empty.
std::string_view tilt_words(const BeaconView& view);

/// "lost", "silent", or the words of the latest status, after "several bridges", "IMU silent" and those of
/// its tilt if these hold.
std::string stream_words(const BeaconView& view);

/// Severity of a beacon's worst fault: 0 is none; from `bad_severity` on, its pose is unreliable.
int severity_of(const BeaconView& view);
/// Severity of the status of one pose.
int severity_of_status(std::uint32_t status);
inline constexpr int bad_severity = 50;

}  // namespace sonopose::observation
