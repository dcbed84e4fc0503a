#pragma once
/// \file
/// The file in which a fusion keeps what it has learned of the sensors until its next start.

#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sonopose::config {

/// An estimate, dated by the host's clock, and the settings that it is true with.
struct LearnedBeacon {
  Estimate estimate;
  std::vector<std::string> mounting;  ///< settings as of `mounting_of`

  bool operator==(const LearnedBeacon&) const = default;
};

using LearnedSensors = std::map<BeaconAddress, LearnedBeacon>;

/// Returns the settings that say which sensor is where, as KEY=VALUE: those of `calibration.*` and the offset
/// of the mount, where they differ from the defaults. What was learned with others does not apply.
std::vector<std::string> mounting_of(const settings::Settings& settings);

/// Reads a file of `learned_toml`. Empty if there is no such file. Throws ConfigError, naming file, line and
/// key, for anything else, and for a beacon without its mounting.
LearnedSensors read_learned(const std::filesystem::path& file);

/// Writes the values that a start uses: biases, lever arm and noise of the fixes, and the mounting.
std::string learned_toml(const LearnedSensors& learned);

}  // namespace sonopose::config
