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

/// Throws IoError for what cannot be read like a file.
void require_file(const std::filesystem::path& file, const struct stat& status, const struct statfs& system) {
  const auto kind = [&]() -> const char* {
    switch (status.st_mode & S_IFMT) {
      case S_IFREG:
        return nullptr;
      case S_IFDIR:
        return "a folder";
      case S_IFIFO:  // one without a name ends when its writer does; a named one may never have a writer
        return system.f_type == PIPEFS_MAGIC ? nullptr : "a named pipe";
      case S_IFCHR:
        return status.st_rdev == makedev(1, 3) ? nullptr : "a device";
      default:
        return S_ISBLK(status.st_mode) ? "a device" : "a socket";
    }
  }();
  if (kind != nullptr) throw IoError(file.string() + ": is " + kind + ", not a file");
}

}  // namespace

Descriptor open_input(const std::filesystem::path& file) {
  struct stat status {};
  struct statfs system {};
  // Opening a device may act on it: a serial line resets what is connected. The check is repeated below,
  // since another thing may have the name by then.
  if (::stat(file.c_str(), &status) == 0 && ::statfs(file.c_str(), &system) == 0) {
    require_file(file, status, system);
  }
  // Without O_NONBLOCK a named pipe waits for a writer, and a serial line for a carrier.
  Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (opened.number() < 0) throw IoError(opening_error(file.string(), errno));
  if (::fstat(opened.number(), &status) != 0 || ::fstatfs(opened.number(), &system) != 0) {
    throw IoError(opening_error(file.string(), errno));
  }
  require_file(file, status, system);
  ::fcntl(opened.number(), F_SETFL, ::fcntl(opened.number(), F_GETFL) & ~O_NONBLOCK);
  return opened;
}

std::string read_text(const std::filesystem::path& file) {
  const Descriptor opened = open_input(file);
  std::string text;
  std::array<char, 65536> buffer{};
  ssize_t count = 0;
  int error = 0;
  do {
    count = ::read(opened.number(), buffer.data(), buffer.size());
    error = count < 0 ? errno : 0;
    if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  } while ((count > 0 && text.size() <= max_text_bytes) || error == EINTR);
  if (error != 0) throw IoError(file.string() + ": cannot be read: " + std::strerror(error));
  if (text.size() > max_text_bytes) {
    throw IoError(file.string() + ": has more than " + std::to_string(max_text_bytes) +
                  " bytes, the limit of such a file");
  }
  return text;
}

}  // namespace sonopose::files
