#pragma once
/// \file
/// What a run leaves on disk, written as it comes, each file with `.part` behind its name until the end:
///
/// | File             | Columns |
/// |------------------|---------|
/// | `trajectory.tum` | `t x y z qx qy qz qw`: s, m; spaces between, as evo and others read it |
/// | `pose.csv`       | time, position, attitude, velocity, status (bits of PoseStatus) |
/// | `fixes.csv`      | every field of FixReport, verdicts in words |

#include <sonopose/core/pose.hpp>
#include <sonopose/io/csv_writer.hpp>
#include <sonopose/io/replacement.hpp>
#include <sonopose/replay/trajectory_file.hpp>

#include <filesystem>

namespace sonopose::replay {

class OutputFolder {
public:
  /// Makes the folder where needed. Throws io::IoError.
  explicit OutputFolder(const std::filesystem::path& folder);

  /// Throw io::IoError, as on a full disk.
  void write(const FusedPose& pose);
  void write(const FixReport& report);

  /// Replaces the files of a run before; without this call they stay. Throws io::IoError.
  void finish();

private:
  struct Table {
    explicit Table(const std::filesystem::path& file)
        : place(file), rows(place.part(), io::CsvWriter::Existing::replace) {}

    io::Replacement place;
    io::CsvWriter rows;
  };

  TrajectoryFile trajectory_;
  Table poses_;
  Table fixes_;
};

}  // namespace sonopose::replay
