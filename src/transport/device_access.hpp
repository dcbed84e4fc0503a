#pragma once
/// \file
/// Who may open a device.

#include <string>

namespace sonopose::transport {

/// What to do about a device that this user may not open: the group to join, or that no group may.
std::string access_remedy(const std::string& device);

}  // namespace sonopose::transport
