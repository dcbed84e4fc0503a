#pragma once
/// \file
/// The name of this process for others. Internal to this module.

#include <dds/dds.h>

namespace sonopose::dds {

/// Adds "process=NAME;pid=NUMBER;host=NAME;" to the user data of a participant, unless the application has
/// data of its own there. Cyclone DDS announces these as properties, but not beside the properties that make
/// a participant secure.
void announce_process(dds_qos_t* qos);

}  // namespace sonopose::dds
