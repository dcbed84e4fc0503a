#pragma once
/// \file
/// Replaces a file atomically.

#include <filesystem>
#include <string_view>

namespace sonopose::files {

/// Writes the new content to `FILE.part` next to FILE. The old content stays until commit(). A FILE that is
/// not a regular file, such as /dev/stdout, is written directly.
class Replacement {
public:
  explicit Replacement(const std::filesystem::path& file);
  /// Deletes the part unless it was committed.
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  /// The file to write to.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }

  /// Moves the part to the file. Throws IoError.
  void commit();

private:
  std::filesystem::path file_;  ///< path with symbolic links resolved
  std::filesystem::path part_;
  bool pending_;
};

/// Writes a text to a file, and replaces an existing one. Throws IoError and leaves the file unchanged if it
/// cannot be written.
void write_whole(const std::filesystem::path& file, std::string_view text);

/// Writes a text like write_whole to a file that only its owner can read and write, from its creation on.
void write_private(const std::filesystem::path& file, std::string_view text);

}  // namespace sonopose::files
