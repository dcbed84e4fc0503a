#pragma once
/// \file
/// Explains who may open a device.

#include <string>

namespace sonopose::transport {

/// Returns a remedy for a device that this user may not open: the group to join, or that no group may.
std::string access_remedy(const std::string& device);

}  // namespace sonopose::transport
