#pragma once
/// \file
/// The origin of a reader's bytes.

#include "files/random_access_file.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace sonopose::mcap {

/// The bytes of one recording, for reading in any order.
class ByteSource {
public:
  virtual ~ByteSource() = default;

  /// Name of the file, for errors.
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Fills `to` with the bytes from `offset` on, all inside the size. Throws files::IoError.
  virtual void read(std::uint64_t offset, std::span<std::byte> to) const = 0;
};

/// A file as a ByteSource.
class FileSource final : public ByteSource {
public:
  /// Throws files::IoError if the file cannot be opened.
  explicit FileSource(const std::filesystem::path& file) : file_{file} {}

  [[nodiscard]] const std::string& name() const override { return file_.name(); }
  [[nodiscard]] std::uint64_t size() const override { return file_.size(); }
  void read(std::uint64_t offset, std::span<std::byte> to) const override { file_.read(offset, to); }

private:
  files::RandomAccessFile file_;
};

}  // namespace sonopose::mcap
