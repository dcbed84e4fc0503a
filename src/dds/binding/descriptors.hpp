#pragma once
/// \file
/// File descriptors that a domain needs. Internal to this module.

#include <string>

namespace sonopose::dds {

/// Cyclone DDS crashes if it cannot open its sockets. Throws `Error` with the limit and the least one that
/// suffices if too few descriptors are free; `about` names the domain.
void check_free_descriptors(const std::string& about);

}  // namespace sonopose::dds
