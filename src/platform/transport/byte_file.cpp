#include "transport/byte_file.hpp"

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "files/missing.hpp"

#include <cerrno>
#include <cstring>

namespace sonopose::transport {

ByteFile::ByteFile(const std::filesystem::path& path)
    // Not files::open_input: a named pipe, whose writer comes later, and a device may play bytes as well.
    : name_{path.string()}, file_{std::fopen(name_.c_str(), "rbe")} {
  if (!file_) throw files::IoError(files::opening_error(name_, errno));
  // A folder can be opened and fails only at the first read.
  if (std::filesystem::is_directory(path)) throw files::IoError(name_ + ": is a folder, not a file");
}

ReadResult ByteFile::read(std::span<std::uint8_t> buffer, std::chrono::milliseconds /*timeout*/) {
  if (stopped_) return {ReadStatus::stopped};
  const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file_.get());
  if (std::ferror(file_.get()) != 0)
    throw files::IoError(name_ + ": cannot be read: " + std::strerror(errno));
  if (count == 0) return {ReadStatus::end};
  return {ReadStatus::data, count, clocks::steady_now()};
}

}  // namespace sonopose::transport
