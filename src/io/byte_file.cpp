#include "append_file.hpp"
#include <sonopose/io/byte_file.hpp>
#include <sonopose/io/error.hpp>

#include <cerrno>
#include <cstring>

namespace sonopose::io {

ByteFile::ByteFile(const std::filesystem::path& path)
    : name_{path.string()}, file_{std::fopen(name_.c_str(), "rbe")} {
  if (!file_) throw IoError(name_ + ": cannot be opened: " + std::strerror(errno));
  // A folder opens, and fails at the first read only.
  if (std::filesystem::is_directory(path)) throw IoError(name_ + ": is a folder and no file");
}

ReadResult ByteFile::read(std::span<std::uint8_t> buffer, std::chrono::milliseconds /*timeout*/) {
  if (stopped_) return {ReadStatus::stopped};
  const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file_.get());
  if (std::ferror(file_.get()) != 0) throw IoError(name_ + ": cannot be read: " + std::strerror(errno));
  if (count == 0) return {ReadStatus::end};
  return {ReadStatus::data, count, host_time_ns()};
}

CaptureFile::CaptureFile(const std::filesystem::path& path)
    : file_{std::make_unique<AppendFile>(path, AppendFile::Existing::extend)} {}

CaptureFile::~CaptureFile() = default;

void CaptureFile::append(std::span<const std::uint8_t> bytes) {
  file_->append(std::as_bytes(bytes));
}

}  // namespace sonopose::io
