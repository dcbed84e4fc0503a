#pragma once
/// \file
/// Files of raw beacon bytes: sources and captures.

#include "transport/byte_source.hpp"

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace sonopose::files {
class AppendFile;
}

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

class CaptureFile {
public:
  /// Throws files::IoError if it cannot be opened.
  explicit CaptureFile(const std::filesystem::path& path);
  ~CaptureFile();
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;
  CaptureFile(CaptureFile&&) = delete;
  CaptureFile& operator=(CaptureFile&&) = delete;

  /// Passes the bytes to the operating system immediately, so that they survive a crash of the process.
  /// Throws files::IoError, for example on a full disk; the file then contains none of these bytes.
  void append(std::span<const std::uint8_t> bytes);

private:
  std::unique_ptr<files::AppendFile> file_;
};

}  // namespace sonopose::transport
