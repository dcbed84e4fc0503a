#pragma once
/// \file
/// The name of this machine.

#include <array>
#include <string>
#include <unistd.h>

namespace sonopose::process {

/// Empty if the system does not have one.
inline std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace sonopose::process
