#pragma once
/// \file
/// A file that is only appended to.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace sonopose::files {

class AppendFile {
public:
  enum class Existing { refuse, extend, replace };

  /// Throws IoError with the cause.
  AppendFile(const std::filesystem::path& path, Existing existing);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;
  AppendFile(AppendFile&&) = delete;
  AppendFile& operator=(AppendFile&&) = delete;

  /// Passes all bytes to the operating system, so that they survive a crash. Throws IoError with the cause; a
  /// regular file then contains none of these bytes, so that it does not end in the middle of a line.
  void append(std::span<const std::byte> bytes);

  /// Reserves space for `byte_count` more bytes, where the file system can. Throws IoError if the disk has
  /// less; what was reserved before stays so. The file gives back at its end what it did not use.
  void reserve(std::uint64_t byte_count);

private:
  void remove_last(std::size_t count) const;

  std::string name_;
  int descriptor_ = -1;
  bool has_reserved_ = false;
};

}  // namespace sonopose::files
