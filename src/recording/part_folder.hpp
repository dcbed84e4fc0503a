#pragma once
/// \file
/// The folder of a recording that is still being written.

#include <filesystem>

namespace sonopose::recording {

/// Throws files::IoError if the folder contains a recording: none is ever overwritten.
void refuse_recording_in(const std::filesystem::path& folder);

/// A recording is written to `FOLDER.part`, and gets its name when it is complete. What was cut short keeps
/// the name with `.part`; it can be read like any other.
class PartFolder {
public:
  /// Creates `FOLDER.part`. Throws files::IoError if that exists or cannot be created, and if `folder` exists
  /// and is not empty.
  explicit PartFolder(const std::filesystem::path& folder);

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }

  /// Removes the part if nothing is in it.
  void remove_if_empty() const noexcept;

  /// Gives the part its name. Throws files::IoError.
  void commit() const;
  /// The same for the only subfolder of the part, which replaces it.
  void commit(const std::filesystem::path& subfolder) const;

private:
  std::filesystem::path folder_;
  std::filesystem::path part_;
};

}  // namespace sonopose::recording
