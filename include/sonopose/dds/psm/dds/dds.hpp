#pragma once
/// \file
/// A subset of the ISO C++ PSM of DDS, over the C API of Cyclone DDS. What compiles with it compiles with
/// cyclonedds-cxx 0.10. Every name is in an inline namespace, so a process can also load that library. Each
/// header says what it leaves out of the PSM: here QosProvider, xtypes, discovery and the lookup of entities.

#include "core/ddscore.hpp"
#include "domain/ddsdomain.hpp"
#include "pub/ddspub.hpp"
#include "sub/ddssub.hpp"
#include "topic/ddstopic.hpp"
