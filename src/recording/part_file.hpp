#pragma once
/// \file
/// The file of a recording that is still being written.

#include <filesystem>

namespace sonopose::recording {

/// As PartFolder: a recording is written to `FILE.part`, and gets its name when it is complete.
class PartFile {
public:
  /// Creates the folder of the file. Throws files::IoError if it cannot be created, or if `FILE` or
  /// `FILE.part` exists: no recording is overwritten.
  explicit PartFile(const std::filesystem::path& file);

  /// What to create and write.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

  /// Gives the part its name. Throws files::IoError, also if such a file has appeared.
  void commit() const;

private:
  std::filesystem::path file_;
  std::filesystem::path part_;
};

/// `FILE.part`.
std::filesystem::path part_of(std::filesystem::path file);

/// Whether neither `FILE` nor `FILE.part` exists.
bool is_free_for_part(const std::filesystem::path& file);

/// Throws files::IoError if PartFile could not begin there.
void check_part_file(const std::filesystem::path& file);

}  // namespace sonopose::recording
