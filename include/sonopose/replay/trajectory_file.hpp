#pragma once
/// \file
/// A trajectory in TUM format, `t x y z qx qy qz qw` with times in seconds, as evo reads it.

#include <sonopose/core/samples.hpp>
#include <sonopose/io/csv_writer.hpp>
#include <sonopose/io/replacement.hpp>

#include <filesystem>

namespace sonopose::replay {

class TrajectoryFile {
public:
  /// Throws io::IoError, as all members do.
  explicit TrajectoryFile(const std::filesystem::path& file);

  void write(TimeNs time_ns, const Vector3d& position_world_m, const Quaterniond& q_body_to_world);

  /// Hands everything to the operating system.
  void flush() { rows_.flush(); }

  /// Takes the place of a file of a run before; without this call that one stays.
  void commit() { place_.commit(); }

private:
  io::Replacement place_;
  io::CsvWriter rows_;
};

/// Makes the folder, and those above it, where they are not there. Throws io::IoError.
void make_folder(const std::filesystem::path& folder);

}  // namespace sonopose::replay
