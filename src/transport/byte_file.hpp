#pragma once
/// \file
/// Files of raw beacon bytes: played as a source, and written as a capture.

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

/// A file's bytes, a buffer at a time and as fast as they are asked for; then `end`.
class ByteFile : public ByteSource {
public:
  /// Throws files::IoError where it cannot be opened.
  explicit ByteFile(const std::filesystem::path& path);

  /// Throws files::IoError where the file cannot be read.
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



/// Keeps raw bytes, after those that the file already holds.
class CaptureFile {
public:
  /// Throws files::IoError where it cannot be opened.
  explicit CaptureFile(const std::filesystem::path& path);
  ~CaptureFile();
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;
  CaptureFile(CaptureFile&&) = delete;
  CaptureFile& operator=(CaptureFile&&) = delete;

  /// Hands the bytes to the operating system at once: they outlive the process. Throws files::IoError, as on a full
  /// disk.
  void append(std::span<const std::uint8_t> bytes);

private:
  std::unique_ptr<files::AppendFile> file_;
};

}  // namespace sonopose::transport
