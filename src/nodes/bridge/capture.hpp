#pragma once
/// \file
/// Captures raw beacon bytes to a file while they are published.

#include "files/append_file.hpp"
#include "publication/background_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace sonopose::bridge {

/// A file of raw bytes, written on a thread of its own.
class Capture {
public:
  /// Throws files::IoError if the file cannot be opened. Later errors end the capture and are logged.
  Capture(const std::filesystem::path& file, publication::FullQueuePolicy when_full)
      : writer_({"the capture", "byte"}, capacity, when_full,
                [to = std::make_shared<files::AppendFile>(file, files::AppendFile::Existing::extend)](
                    std::span<const std::uint8_t> bytes) { to->append(std::as_bytes(bytes)); }) {}

  /// Limits waits of `append` for a slow disk after the stop. `stop` must outlive this.
  void obey(const process::StopSignal& stop) { writer_.obey(stop); }

  void append(std::span<const std::uint8_t> bytes) { writer_.push(bytes); }

  /// Waits until everything has been written (BackgroundWriter::finish). Throws files::IoError if bytes were
  /// lost.
  void finish() { writer_.finish(); }

private:
  static constexpr std::size_t capacity = 1U << 20U;  ///< many seconds of the fastest serial line

  publication::BackgroundWriter<std::uint8_t> writer_;
};

}  // namespace sonopose::bridge
