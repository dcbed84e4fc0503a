#pragma once
/// \file
/// The file in which a fusion keeps what it has learned of the sensors until its next start.

#include <sonopose/samples/pose.hpp>

#include <filesystem>
#include <map>
#include <string>

namespace sonopose::config {

/// Estimates by beacon, dated by the host's clock.
using LearnedSensors = std::map<BeaconAddress, Estimate>;

/// Reads a file of `learned_toml`. Empty if there is no such file. Throws ConfigError, naming file, line and
/// key, for anything else.
LearnedSensors read_learned(const std::filesystem::path& file);

/// Writes the values that a start uses: biases, lever arm and noise of the fixes.
std::string learned_toml(const LearnedSensors& learned);

}  // namespace sonopose::config
