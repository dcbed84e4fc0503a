#include "files/replacement.hpp"

#include "files/append_file.hpp"
#include "files/descriptor.hpp"
#include "files/error.hpp"

#include <cerrno>
#include <fcntl.h>
#include <span>
#include <string>
#include <system_error>
#include <unistd.h>

namespace sonopose::files {

namespace fs = std::filesystem;

namespace {

/// Waits until a file is on its medium.
void sync_file(const fs::path& file) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.number() < 0 || ::fsync(opened.number()) != 0)
    throw IoError(file.string() + ": cannot be written: " + std::generic_category().message(errno));
}

}  // namespace

Replacement::Replacement(const fs::path& file) : file_{file} {
  std::error_code none_yet;
  if (const fs::path target = fs::canonical(file, none_yet); !none_yet) file_ = target;
  const bool is_special = fs::exists(file_, none_yet) && !fs::is_regular_file(file_, none_yet);
  pending_ = !is_special;
  part_ = is_special ? file : fs::path(file_.native() + ".part");
}

Replacement::~Replacement() {
  std::error_code ignored;
  if (pending_) fs::remove(part_, ignored);
}

void Replacement::commit() {
  if (!pending_) return;
  std::error_code error;
  fs::rename(part_, file_, error);
  if (error) throw IoError(file_.string() + ": cannot be replaced: " + error.message());
  pending_ = false;
}

void write_whole(const fs::path& file, std::string_view text) {
  Replacement replacement(file);
  AppendFile(replacement.part(), AppendFile::Existing::replace).append(std::as_bytes(std::span(text)));
  replacement.commit();
}

void write_private(const fs::path& file, std::string_view text) {
  Replacement replacement(file);
  const fs::path& part = replacement.part();
  std::error_code none_yet;
  fs::remove(part, none_yet);
  const Descriptor created(::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (created.number() < 0) {
    throw IoError(part.string() + ": cannot be created: " + std::generic_category().message(errno));
  }
  AppendFile(part, AppendFile::Existing::extend).append(std::as_bytes(std::span(text)));
  sync_file(part);  // before it replaces the old one, which nothing could bring back
  replacement.commit();
}

}  // namespace sonopose::files
