#pragma once
/// \file
/// The folder of a recording that is still being written.

#include <filesystem>

namespace sonopose::recording {

/// Throws files::IoError if the folder contains a recording: none is ever overwritten.
void refuse_recording_in(const std::filesystem::path& folder);

/// Writes a recording to `FOLDER.part`, which gets its final name when it is complete. An incomplete
/// recording keeps `.part`, and can be read like any other.
class PartFolder {
public:
  /// Creates `FOLDER.part`. Throws files::IoError if it exists or cannot be created, or if `folder` exists
  /// and is not empty.
  explicit PartFolder(const std::filesystem::path& folder);

  /// The folder to write to.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }

  void remove_if_empty() const noexcept;

  /// Gives the part its final name. Throws files::IoError.
  void commit() const;
  /// Gives the final name to the only subfolder of the part, which replaces it. Throws files::IoError.
  void commit(const std::filesystem::path& subfolder) const;

private:
  std::filesystem::path folder_;
  std::filesystem::path part_;
};

}  // namespace sonopose::recording
