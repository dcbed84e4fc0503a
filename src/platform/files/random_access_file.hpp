#pragma once
/// \file
/// A file that is read in any order.

#include "files/input_file.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace sonopose::files {

/// A regular file, open for reading in any order.
class RandomAccessFile {
public:
  /// Throws IoError if the file cannot be opened or is not a regular file.
  explicit RandomAccessFile(const std::filesystem::path& file);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// The size when the file was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Fills `to` with the bytes from `offset` on. Throws IoError if the file has fewer.
  void read(std::uint64_t offset, std::span<std::byte> to) const;

private:
  std::string name_;
  Descriptor file_;
  std::uint64_t size_ = 0;
};

}  // namespace sonopose::files
