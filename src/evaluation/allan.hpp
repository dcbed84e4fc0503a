#pragma once
/// \file
/// The Allan deviation of a log at rest: as a table, as JSON, and as a picture.

#include "calibration/fit/allan.hpp"
#include "files/replacement.hpp"

#include <cstddef>
#include <filesystem>
#include <string>

namespace sonopose::evaluation {

struct AllanResult {
  std::filesystem::path log;
  std::size_t samples = 0;
  calibration::AllanReport report;
};

/// Reads imu.csv of the log folder. Throws files::IoError, and CalibrationError that names the file.
AllanResult analyse_allan(const std::filesystem::path& log);

/// A table, a line per axis; "not seen" where the record does not show a number.
std::string allan_text(const AllanResult& result);

/// One JSON object with the curves, rows of [tau_s, deviation, relative_error]; null for what is not seen.
std::string allan_json(const AllanResult& result);

/// The curves of both sensors with the line of the noise density and the floor. Drawn by gnuplot.
class AllanPicture {
public:
  /// `file` ends in .svg or .png. Throws plots::PictureError (picture.hpp) for another ending and where gnuplot is
  /// not installed, files::IoError where the file cannot be written.
  explicit AllanPicture(std::filesystem::path file);

  /// Replaces the file. Throws plots::PictureError where gnuplot fails; the file then stays as it was.
  void draw(const AllanResult& result);

private:
  std::filesystem::path file_;
  files::Replacement replacement_;
};

}  // namespace sonopose::evaluation
