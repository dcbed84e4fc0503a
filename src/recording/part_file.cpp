#include "recording/part_file.hpp"

#include "files/error.hpp"

#include <string>
#include <system_error>

namespace sonopose::recording {

namespace fs = std::filesystem;

namespace {

fs::path part_of(fs::path file) {
  return file += ".part";
}

void refuse_existing(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(file, error))) return;
  throw files::IoError(file.string() + ": exists; a recording is not overwritten");
}

}  // namespace

void check_part_file(const fs::path& file) {
  refuse_existing(file);
  std::error_code error;
  if (!fs::exists(fs::symlink_status(part_of(file), error))) return;
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
