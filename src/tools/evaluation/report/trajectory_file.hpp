#pragma once
/// \file
/// Writes a trajectory in TUM format, `t x y z qx qy qz qw` with times in seconds, as evo reads it.

#include "csv/writer.hpp"
#include "files/replacement.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>

namespace sonopose::evaluation {

class TrajectoryFile {
public:
  /// Throws files::IoError, like all members.
  explicit TrajectoryFile(const std::filesystem::path& file);

  void write(TimeNs time_ns, const Vector3d& position_world_m, const Quaterniond& q_body_to_world);

  /// Writes everything to the operating system.
  void flush() { rows_.flush(); }

  /// Replaces the file of an earlier run. Without this call that file remains.
  void commit() { place_.commit(); }

private:
  files::Replacement place_;
  csv::Writer rows_;
};

/// Creates the folder and its parents if necessary. Throws files::IoError.
void make_folder(const std::filesystem::path& folder);

}  // namespace sonopose::evaluation
