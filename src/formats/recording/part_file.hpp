#pragma once
/// \file
/// The file of a recording that is still being written.

#include <filesystem>

namespace sonopose::recording {

/// Writes a recording to `FILE.part`, which gets its final name when it is complete, as in PartFolder.
class PartFile {
public:
  /// Creates the folder of the file. Throws files::IoError if it cannot be created, or if `FILE` or
  /// `FILE.part` exists: no recording is overwritten.
  explicit PartFile(const std::filesystem::path& file);

  /// The file to create and write.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

  /// Gives the part its final name. Throws files::IoError, also if a file of that name has appeared.
  void commit() const;

private:
  std::filesystem::path file_;
  std::filesystem::path part_;
};

std::filesystem::path part_of(std::filesystem::path file);

/// Returns true if neither `FILE` nor `FILE.part` exists.
bool is_free_for_part(const std::filesystem::path& file);

/// Throws files::IoError if a PartFile could not be created there.
void check_part_file(const std::filesystem::path& file);

}  // namespace sonopose::recording
