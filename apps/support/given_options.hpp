#pragma once
// What a user gave on the command line, as values and as arguments for another program.

#include <CLI/CLI.hpp>

#include <string>
#include <utility>
#include <vector>

namespace sonopose::apps {

/// Name and value: {"imu_rate", "200"}.
using NamedValues = std::vector<std::pair<std::string, std::string>>;

/// The options of a group that were given, and those of `always` with their defaults.
NamedValues option_values(const CLI::App& app, const std::string& group,
                          const std::vector<std::string>& always);

/// The options of a group that were given, as arguments: "--source=sim".
std::vector<std::string> option_arguments(const CLI::App& app, const std::string& group);

}  // namespace sonopose::apps
