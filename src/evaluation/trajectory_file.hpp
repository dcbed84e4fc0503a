#pragma once
/// \file
/// A trajectory in TUM format, `t x y z qx qy qz qw` with times in seconds, as evo reads it.

#include <sonopose/samples/samples.hpp>
#include "files/csv_writer.hpp"
#include "files/replacement.hpp"

#include <filesystem>

namespace sonopose::evaluation {

class TrajectoryFile {
public:
  /// Throws files::IoError, as all members do.
  explicit TrajectoryFile(const std::filesystem::path& file);

  void write(TimeNs time_ns, const Vector3d& position_world_m, const Quaterniond& q_body_to_world);

  /// Hands everything to the operating system.
  void flush() { rows_.flush(); }

  /// Takes the place of a file of a run before; without this call that one stays.
  void commit() { place_.commit(); }

private:
  files::Replacement place_;
  files::CsvWriter rows_;
};

/// Makes the folder, and those above it, where they are not there. Throws files::IoError.
void make_folder(const std::filesystem::path& folder);

}  // namespace sonopose::evaluation
