#include "files/input_file.hpp"

#include "files/error.hpp"
#include "files/missing.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace sonopose::files {
namespace {

/// Returns true for a pipe without a name, which ends when its writer does. A named one may never have a
/// writer.
bool is_unnamed_pipe(int descriptor) {
  struct statfs system {};
  return ::fstatfs(descriptor, &system) == 0 && system.f_type == PIPEFS_MAGIC;
}

/// Returns what cannot be read like a file; null for what can.
const char* unreadable_kind(int descriptor, const struct stat& status) {
  switch (status.st_mode & S_IFMT) {
    case S_IFREG:
      return nullptr;
    case S_IFDIR:
      return "a folder";
    case S_IFIFO:
      return is_unnamed_pipe(descriptor) ? nullptr : "a named pipe";
    case S_IFCHR:
      return status.st_rdev == makedev(1, 3) ? nullptr : "a device";
    default:
      return S_ISBLK(status.st_mode) ? "a device" : "a socket";
  }
}

}  // namespace

int open_input(const std::filesystem::path& file) {
  // Without O_NONBLOCK a named pipe waits for a writer, and a serial line for a carrier.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) {
    const int error = errno;
    throw IoError(error == ENXIO ? file.string() + ": is a socket or a device, not a file"
                                 : opening_error(file.string(), error));
  }
  struct stat status {};
  const char* const kind =
      ::fstat(descriptor, &status) == 0 ? unreadable_kind(descriptor, status) : "unknown to the system";
  if (kind != nullptr) {
    ::close(descriptor);
    throw IoError(file.string() + ": is " + kind + ", not a file");
  }
  ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
  return descriptor;
}

std::string read_text(const std::filesystem::path& file) {
  const int descriptor = open_input(file);
  std::string text;
  std::array<char, 65536> buffer{};
  ssize_t count = 0;
  int error = 0;
  do {
    count = ::read(descriptor, buffer.data(), buffer.size());
    error = count < 0 ? errno : 0;
    if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  } while ((count > 0 && text.size() <= max_text_bytes) || error == EINTR);
  ::close(descriptor);
  if (error != 0) throw IoError(file.string() + ": cannot be read: " + std::strerror(error));
  if (text.size() > max_text_bytes) {
    throw IoError(file.string() + ": has more than " + std::to_string(max_text_bytes) +
                  " bytes, the limit of such a file");
  }
  return text;
}

}  // namespace sonopose::files
