#pragma once
/// \file
/// Checks the file descriptors that a domain needs. Internal to this module.

#include <string>

namespace sonopose::dds {

/// Throws `Error` with the limit and the least sufficient one if too few descriptors are free. Cyclone DDS
/// crashes if it cannot open its sockets. `about` names the domain.
void check_free_descriptors(const std::string& about);

}  // namespace sonopose::dds
