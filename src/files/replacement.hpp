#pragma once
/// \file
/// A file that takes the place of another one only when it is whole.

#include <filesystem>

namespace sonopose::files {

/// While the new content is being written it stands in `FILE.part` beside FILE; whatever goes wrong until
/// then, the old content stays. A FILE that is no regular one, as /dev/stdout, is written to directly.
class Replacement {
public:
  explicit Replacement(const std::filesystem::path& file);
  /// Without a commit() the part is deleted.
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;
  Replacement(Replacement&&) = delete;
  Replacement& operator=(Replacement&&) = delete;

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }

  /// Puts what was written in the file's place. Throws IoError.
  void commit();

private:
  std::filesystem::path file_;  ///< behind any symbolic link
  std::filesystem::path part_;
  bool pending_;
};

}  // namespace sonopose::files
