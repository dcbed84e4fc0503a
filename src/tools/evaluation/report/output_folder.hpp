#pragma once
/// \file
/// Writes the output files of a run. Each is written incrementally as FILE.part and renamed at the end:
///
/// | File             | Columns |
/// |------------------|---------|
/// | `trajectory.tum` | `t x y z qx qy qz qw` from the first position on, in s and m, as evo reads it |
/// | `pose.csv`       | time, position, attitude, velocity, status (bits of PoseStatus) |
/// | `covariance.csv` | on request: time, upper triangles of position, rotation and velocity |
/// | `fixes.csv`      | every field of FixReport, the flags also as names |

#include "csv/writer.hpp"
#include "evaluation/report/trajectory_file.hpp"
#include "files/replacement.hpp"
#include <sonopose/samples/pose.hpp>

#include <filesystem>
#include <optional>

namespace sonopose::evaluation {

class OutputFolder {
public:
  enum class Covariances { no, yes };

  /// Creates the folder if necessary. Throws files::IoError.
  explicit OutputFolder(const std::filesystem::path& folder, Covariances covariances = Covariances::no);

  /// Both throw files::IoError, for instance on a full disk.
  void write(const FusedPose& pose);
  void write(const FixReport& report);

  /// Replaces or removes the files of an earlier run. Without this call they remain. Throws files::IoError.
  void finish();

private:
  void write_covariances(const FusedPose& pose);

  struct Table {
    explicit Table(const std::filesystem::path& file)
        : place(file), rows(place.part(), csv::Writer::Existing::replace) {}

    files::Replacement place;
    csv::Writer rows;
  };

  std::filesystem::path covariance_file_;
  TrajectoryFile trajectory_;
  Table poses_;
  Table fixes_;
  std::optional<Table> covariances_;
};

}  // namespace sonopose::evaluation
