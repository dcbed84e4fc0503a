#pragma once
/// \file
/// A file as the sink of a writer.

#include "files/append_file.hpp"
#include "mcap/byte_sink.hpp"

#include <filesystem>

namespace sonopose::mcap {

/// Passes each append to the operating system immediately, so that it survives a crash of the process.
class FileSink final : public ByteSink {
public:
  /// Throws files::IoError if the file exists or cannot be created.
  explicit FileSink(const std::filesystem::path& file) : file_{file, files::AppendFile::Existing::refuse} {}

  void append(std::span<const std::byte> bytes) override { file_.append(bytes); }
  void reserve(std::uint64_t byte_count) override { file_.reserve(byte_count); }

private:
  files::AppendFile file_;
};

}  // namespace sonopose::mcap
