#pragma once
/// \file
/// Computes the Allan deviation of a recording at rest, as a table and as JSON.

#include "calibration/fit/allan.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::evaluation {

struct AllanResult {
  std::filesystem::path log;
  std::size_t samples = 0;
  calibration::fit::AllanReport report;
};

/// Reads imu.csv of the log folder. Throws files::IoError, and a CalibrationError that names the file.
AllanResult analyse_allan(const std::filesystem::path& log, std::optional<BeaconAddress> beacon = {});

/// Writes a table with one line per axis; "not seen" if the record is too short to show a value.
std::string allan_text(const AllanResult& result);

/// Writes one JSON object with the curves as rows of [tau_s, deviation, relative_error]; null for values that
/// the record does not show.
std::string allan_json(const AllanResult& result);

}  // namespace sonopose::evaluation
