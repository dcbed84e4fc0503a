#include "files/append_file.hpp"

#include "files/error.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/resource.h>
#include <tuple>
#include <unistd.h>

namespace sonopose::files {

namespace {

int open_mode(AppendFile::Existing existing) {
  switch (existing) {
    case AppendFile::Existing::refuse:
      return O_EXCL;
    case AppendFile::Existing::extend:
      return O_APPEND;
    case AppendFile::Existing::replace:
      return O_TRUNC;
  }
  return O_EXCL;
}

}  // namespace

AppendFile::AppendFile(const std::filesystem::path& path, Existing existing) : name_{path.string()} {
  descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | open_mode(existing), 0666);
  if (descriptor_ < 0) throw IoError(name_ + ": cannot be created: " + std::strerror(errno));
}

AppendFile::~AppendFile() {
  const off_t size = has_reserved_ ? ::lseek(descriptor_, 0, SEEK_END) : -1;
  // If this fails, the space stays reserved until the file is removed.
  if (size >= 0) std::ignore = ::ftruncate(descriptor_, size);
  ::close(descriptor_);
}

void AppendFile::append(std::span<const std::byte> bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(descriptor_, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int cause = errno;
      remove_last(written);
      throw IoError(name_ + ": cannot be written: " + std::strerror(cause));
    }
    written += static_cast<std::size_t>(count);
  }
}

void AppendFile::reserve(std::uint64_t byte_count) {
  const off_t size = ::lseek(descriptor_, 0, SEEK_END);
  if (size < 0) return;  // not a regular file
  // A file that keeps its size is not checked against this limit; its later bytes are.
  rlimit limit{};
  const bool is_limited = ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  if (is_limited && static_cast<rlim_t>(size) + byte_count > limit.rlim_cur) {
    throw IoError(name_ + ": cannot be written: " + std::strerror(EFBIG));
  }
  has_reserved_ = true;
  if (::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, size, static_cast<off_t>(byte_count)) == 0) return;
  if (errno == ENOSPC || errno == EDQUOT || errno == EFBIG) {
    throw IoError(name_ + ": cannot be written: " + std::strerror(errno));
  }
}

void AppendFile::remove_last(std::size_t count) const {
  const off_t size = ::lseek(descriptor_, 0, SEEK_END);
  if (count == 0 || size < 0) return;  // nothing to remove, or not a regular file
  const off_t before = size - static_cast<off_t>(count);
  if (::ftruncate(descriptor_, before) == 0) ::lseek(descriptor_, before, SEEK_SET);
}

}  // namespace sonopose::files
