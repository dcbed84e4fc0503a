#pragma once
/// \file
/// A subset of the ISO C++ PSM of DDS, over the C API of Cyclone DDS. Code that uses only the
/// names of the PSM compiles with cyclonedds-cxx 0.10 too; what is beyond the PSM says so. Every name is in
/// an inline namespace, so a process can also load that library. Each header says what it leaves out of the
/// PSM: here QosProvider, xtypes, discovery and the lookup of entities.

#include "core/ddscore.hpp"
#include "domain/ddsdomain.hpp"
#include "pub/ddspub.hpp"
#include "sub/ddssub.hpp"
#include "topic/ddstopic.hpp"
