#pragma once
/// \file
/// Number of seeds over which a test scores the accuracy.

#include <cstdlib>

namespace sonopose::test {

/// `few` in the suite, `many` with SONOPOSE_MANY_SEEDS in the environment (`scripts/check accuracy`).
inline unsigned seeds(unsigned few, unsigned many) {
  return std::getenv("SONOPOSE_MANY_SEEDS") == nullptr ? few : many;
}

}  // namespace sonopose::test
