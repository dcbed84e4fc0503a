#pragma once
/// \file
/// The host's clock, read in this one place.

#include <sonopose/samples/samples.hpp>

#include <chrono>

namespace sonopose::process {

/// Now, ns since the Unix epoch.
inline TimeNs now_ns() {
  using std::chrono::duration_cast;
  return duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Now by a clock that nobody sets, for waiting and timing out.
inline TimeNs steady_now_ns() {
  using std::chrono::duration_cast;
  return duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace sonopose::process
