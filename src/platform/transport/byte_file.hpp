#pragma once
/// \file
/// Files of raw beacon bytes as sources.

#include "transport/byte_source.hpp"

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace sonopose::transport {

/// Reads a file's bytes, one buffer per read; then `end`.
class ByteFile : public ByteSource {
public:
  /// Throws files::IoError if it cannot be opened.
  explicit ByteFile(const std::filesystem::path& path);

  /// Throws files::IoError if the file cannot be read.
  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override;
  void stop() override { stopped_ = true; }
  [[nodiscard]] std::string name() const override { return name_; }

private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::atomic<bool> stopped_ = false;
};

}  // namespace sonopose::transport
