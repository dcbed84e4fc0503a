#pragma once
/// \file
/// Number of seeds over which a test scores the accuracy.

#include <cstdlib>

namespace sonopose::test {

/// Returns `few` in the suite, or `many` if SONOPOSE_MANY_SEEDS is set (`scripts/check accuracy`).
inline unsigned seeds(unsigned few, unsigned many) {
  return std::getenv("SONOPOSE_MANY_SEEDS") == nullptr ? few : many;
}

}  // namespace sonopose::test
