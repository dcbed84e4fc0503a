#pragma once
// The host's time, as certificates have it.

#include "clocks/clocks.hpp"

#include <cstdint>

namespace sonopose::apps {

/// Returns the seconds since 1970.
inline std::int64_t host_now_s() {
  return clocks::host_now() / 1'000'000'000;
}

}  // namespace sonopose::apps
