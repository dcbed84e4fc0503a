#pragma once
/// \file
/// Counts the allocations of the test program with `new`, which includes all containers.

#include <cstddef>

namespace sonopose::test {

/// Number of allocations since the start of the program.
std::size_t allocations();

}  // namespace sonopose::test
