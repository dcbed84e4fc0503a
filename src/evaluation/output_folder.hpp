#pragma once
/// \file
/// What a run leaves on disk, written as it comes, each file with `.part` behind its name until the end:
///
/// | File             | Columns |
/// |------------------|---------|
/// | `trajectory.tum` | `t x y z qx qy qz qw`: s, m; spaces between, as evo and others read it |
/// | `pose.csv`       | time, position, attitude, velocity, status (bits of PoseStatus) |
/// | `fixes.csv`      | every field of FixReport, fix_flags in words |

#include <sonopose/samples/pose.hpp>
#include "files/csv_writer.hpp"
#include "files/replacement.hpp"
#include "evaluation/trajectory_file.hpp"

#include <filesystem>

namespace sonopose::evaluation {

class OutputFolder {
public:
  /// Makes the folder where needed. Throws files::IoError.
  explicit OutputFolder(const std::filesystem::path& folder);

  /// Throw files::IoError, as on a full disk.
  void write(const FusedPose& pose);
  void write(const FixReport& report);

  /// Replaces the files of a run before; without this call they stay. Throws files::IoError.
  void finish();

private:
  struct Table {
    explicit Table(const std::filesystem::path& file)
        : place(file), rows(place.part(), files::CsvWriter::Existing::replace) {}

    files::Replacement place;
    files::CsvWriter rows;
  };

  TrajectoryFile trajectory_;
  Table poses_;
  Table fixes_;
};

}  // namespace sonopose::evaluation
