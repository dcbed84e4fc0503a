#pragma once
/// \file
/// The name of this machine.

#include <array>
#include <string>
#include <unistd.h>

namespace sonopose::process {

/// Returns empty if the system has no name.
inline std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace sonopose::process
