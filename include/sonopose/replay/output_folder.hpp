#pragma once
/// \file
/// What a run leaves on disk, written as it comes:
///
/// | File             | Columns |
/// |------------------|---------|
/// | `trajectory.tum` | `t x y z qx qy qz qw`: s, m; spaces between, as evo and others read it |
/// | `pose.csv`       | time, position, attitude, velocity, status (bits of PoseStatus) |
/// | `fixes.csv`      | every field of FixReport, verdicts in words |

#include <sonopose/core/pose.hpp>
#include <sonopose/io/csv_writer.hpp>

#include <filesystem>

namespace sonopose::replay {

class OutputFolder {
public:
  /// Makes the folder where needed and replaces the three files in it. Throws io::IoError.
  explicit OutputFolder(const std::filesystem::path& folder);

  /// Throw io::IoError, as on a full disk.
  void write(const FusedPose& pose);
  void write(const FixReport& report);

  /// Hands everything to the operating system. Throws io::IoError.
  void flush();

private:
  io::CsvWriter trajectory_;
  io::CsvWriter poses_;
  io::CsvWriter fixes_;
};

}  // namespace sonopose::replay
