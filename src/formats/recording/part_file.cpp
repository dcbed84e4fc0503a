#include "recording/part_file.hpp"

#include "files/error.hpp"

#include <string>
#include <system_error>

namespace sonopose::recording {

namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::exists(fs::symlink_status(file, error));
}

void refuse_existing(const fs::path& file) {
  if (!is_there(file)) return;
  throw files::IoError(file.string() + ": exists; a recording is not overwritten");
}

}  // namespace

fs::path part_of(fs::path file) {
  return file += ".part";
}

bool is_free_for_part(const fs::path& file) {
  return !is_there(file) && !is_there(part_of(file));
}

void check_part_file(const fs::path& file) {
  refuse_existing(file);
  if (!is_there(part_of(file))) return;
  throw files::IoError(
      part_of(file).string() +
      ": exists: another program writes it, or an interrupted recording left it; move or delete it");
}

PartFile::PartFile(const fs::path& file) : file_{file}, part_{part_of(file)} {
  check_part_file(file_);
  if (!file_.has_parent_path()) return;
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  if (error) throw files::IoError(file_.parent_path().string() + ": cannot be created: " + error.message());
}

void PartFile::commit() const {
  refuse_existing(file_);
  std::error_code error;
  fs::rename(part_, file_, error);
  if (error) {
    throw files::IoError(part_.string() + ": cannot be renamed to " + file_.string() + ": " +
                         error.message());
  }
}

}  // namespace sonopose::recording
