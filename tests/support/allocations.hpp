#pragma once
/// \file
/// Counts what the test's program allocates with `new`, and so what all containers do.

#include <cstddef>

namespace sonopose::test {

/// Since the program's start.
std::size_t allocations();

}  // namespace sonopose::test
