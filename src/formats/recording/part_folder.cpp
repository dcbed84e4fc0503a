#include "recording/part_folder.hpp"

#include "files/error.hpp"
#include "files/missing.hpp"
#include "recording/log_columns.hpp"

#include <string>
#include <string_view>
#include <system_error>

namespace sonopose::recording {

namespace fs = std::filesystem;

namespace {

/// Removes a trailing slash, and replaces dots by a name.
fs::path named(const fs::path& folder) {
  fs::path plain = folder.lexically_normal();
  if (!plain.has_filename()) plain = plain.parent_path();
  return plain.filename() == "." || plain.filename() == ".." ? fs::weakly_canonical(plain) : plain;
}

void check_free(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  if (!fs::is_directory(folder, error))
    throw files::IoError(folder.string() + ": exists and is not a folder");
  refuse_recording_in(folder);
  const bool is_empty = fs::is_empty(folder, error);
  if (error) throw files::IoError(folder.string() + ": cannot be read: " + error.message());
  if (!is_empty) throw files::IoError(folder.string() + ": is not empty; a recording needs a new folder");
}

}  // namespace

void refuse_recording_in(const fs::path& folder) {
  for (const std::string_view name :
       {imu_file, ultrasonic_file, heading_file, twist_file, truth_file, meta_file}) {
    if (files::is_present(folder / name)) {
      throw files::IoError(folder.string() + ": already contains a recording (" + std::string(name) +
                           "), which is not overwritten");
    }
  }
}

PartFolder::PartFolder(const fs::path& folder) : folder_{named(folder)}, part_{folder_} {
  part_ += ".part";
  check_free(folder_);
  std::error_code error;
  if (folder_.has_parent_path()) fs::create_directories(folder_.parent_path(), error);
  const bool is_new = !error && fs::create_directory(part_, error);
  if (error) throw files::IoError(part_.string() + ": cannot be created: " + error.message());
  if (!is_new) {
    throw files::IoError(part_.string() +
                         ": exists: another program writes it, or an interrupted recording left it; move or "
                         "delete it");
  }
}

void PartFolder::remove_if_empty() const noexcept {
  std::error_code is_not_empty;
  fs::remove(part_, is_not_empty);
}

void PartFolder::commit() const {
  std::error_code error;
  fs::rename(part_, folder_, error);
  if (error) {
    throw files::IoError(part_.string() + ": cannot be renamed to " + folder_.string() + ": " +
                         error.message());
  }
}

void PartFolder::commit(const fs::path& subfolder) const {
  std::error_code error;
  fs::rename(subfolder, folder_, error);
  if (error) {
    throw files::IoError(subfolder.string() + ": cannot be renamed to " + folder_.string() + ": " +
                         error.message());
  }
  fs::remove(part_, error);
  if (error) throw files::IoError(part_.string() + ": cannot be removed: " + error.message());
}

}  // namespace sonopose::recording
