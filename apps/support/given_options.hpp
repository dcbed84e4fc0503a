#pragma once
// The user's options, as values and as arguments for another program.

#include "command_line.hpp"

#include <string>
#include <utility>
#include <vector>

namespace sonopose::apps {

/// Pairs such as {"imu_rate", "200"}.
using NamedValues = std::vector<std::pair<std::string, std::string>>;

/// Returns the given options of a group, and those of `always` with their defaults.
NamedValues option_values(const CommandLine& app, const std::string& group,
                          const std::vector<std::string>& always);

/// Returns the given options of a group as arguments: "--source=sim".
std::vector<std::string> option_arguments(const CommandLine& app, const std::string& group);

}  // namespace sonopose::apps
