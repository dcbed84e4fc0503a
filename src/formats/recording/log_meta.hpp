#pragma once
/// \file
/// Reads and writes `meta.toml` of a sensor-log folder, which has what the CSV files do not say.
///
/// | Key               | Value |
/// |-------------------|-------|
/// | `imu_meaning`     | "unknown", "instant" or "mean": ImuSample::meaning of all samples |
/// | `beacon_address`  | 0 … 65534: the address of all samples |
/// | `program_version` | the version that wrote the folder, as text |
/// | `settings.NAME`   | an option of the program that wrote the folder, as text: where the samples come from
/// |
///
/// The file and each key are optional. Unknown keys are errors, as in the fusion's configuration.

#include "files/error.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::recording {

/// Pairs of name and value.
using LogSettings = std::vector<std::pair<std::string, std::string>>;

struct LogMeta {
  ImuMeaning imu_meaning = ImuMeaning::unknown;
  std::optional<BeaconAddress> beacon_address = {};  ///< address; empty if the folder does not name it
  std::string program_version = {};                  ///< version; empty if the folder does not name it
  LogSettings settings = {};                         ///< settings; sorted by name when read

  bool operator==(const LogMeta&) const = default;
};

std::string program_version();

/// Reads the file of a folder; without one, all values have their defaults. Throws files::IoError that names
/// file, line, key, value and what is allowed.
LogMeta read_log_meta(const std::filesystem::path& folder);

/// Replaces the file of the folder. Throws files::IoError.
void write_log_meta(const std::filesystem::path& folder, const LogMeta& meta);

}  // namespace sonopose::recording
