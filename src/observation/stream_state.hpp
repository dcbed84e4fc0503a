#pragma once
/// \file
/// The state of a beacon's pose stream: in words, and how bad it is.

#include "observation/beacon_observer.hpp"

#include <string>

namespace sonopose::observation {

/// "lost", "silent", or the words of the latest status, which "IMU silent" precedes.
std::string stream_words(const BeaconView& view);

/// The worst fault of a beacon: 0 is none; from `bad_severity` on its pose cannot be relied on.
int severity_of(const BeaconView& view);
/// The same of the status of one pose.
int severity_of_status(std::uint32_t status);
inline constexpr int bad_severity = 50;

}  // namespace sonopose::observation
