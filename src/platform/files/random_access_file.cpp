#include "files/random_access_file.hpp"

#include "files/error.hpp"

#include <cerrno>
#include <cstring>
#include <sys/stat.h>
#include <unistd.h>

namespace sonopose::files {

RandomAccessFile::RandomAccessFile(const std::filesystem::path& file)
    : name_{file.string()}, file_{open_input(file)} {
  struct stat status {};
  if (::fstat(file_.number(), &status) != 0 || !S_ISREG(status.st_mode)) {
    throw IoError(name_ + ": is not a regular file");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

void RandomAccessFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  while (!to.empty()) {
    const ssize_t count = ::pread(file_.number(), to.data(), to.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw IoError(name_ + ": cannot be read: " + std::strerror(errno));
    if (count == 0) throw IoError(name_ + ": ends at byte " + std::to_string(offset) + ", it became shorter");
    to = to.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
}

}  // namespace sonopose::files
