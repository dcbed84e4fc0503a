#pragma once
/// \file
/// The roles of processes on the bus: which topics each may write and read.

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::security {

/// Names of topics on DDS, or patterns of them.
struct Access {
  std::vector<std::string> writes;
  std::vector<std::string> reads;
};

inline constexpr std::array role_names{"bridge",   "fusion", "monitor",   "operator", "ros2",
                                       "recorder", "web",    "autopilot", "consumer"};

/// Returns what processes with all of these roles may do. Throws SecurityError for an unknown role.
Access access_of(const std::vector<std::string>& roles);

/// Returns the role of a program by its verb, such as "recorder" for "record".
std::string_view role_of_program(std::string_view verb);

}  // namespace sonopose::security
