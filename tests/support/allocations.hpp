#pragma once
/// \file
/// Counts the test program's allocations with `new`, which includes all containers.

#include <cstddef>

namespace sonopose::test {

/// Number of allocations since the start of the program.
std::size_t allocations();

}  // namespace sonopose::test
