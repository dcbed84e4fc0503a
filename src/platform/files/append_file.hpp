#pragma once
/// \file
/// A file that is only appended to.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace sonopose::files {

/// A file that grows at its end only. Bytes are in the operating system when `append` returns.
class AppendFile {
public:
  enum class Existing { refuse, extend, replace };

  /// Throws IoError with the cause.
  AppendFile(const std::filesystem::path& path, Existing existing);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// Passes all bytes to the operating system, so that they survive a crash. Throws IoError with the cause. A
  /// regular file then contains none of these bytes, so that it does not end within a line.
  void append(std::span<const std::byte> bytes);

  /// Reserves space for `byte_count` more bytes, if the file system supports it. Throws IoError if the disk
  /// has less; earlier reservations stay. The destructor releases unused space.
  void reserve(std::uint64_t byte_count);

private:
  void remove_last(std::size_t count) const;

  std::string name_;
  int descriptor_ = -1;
  bool has_reserved_ = false;
};

}  // namespace sonopose::files
