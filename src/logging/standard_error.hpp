#pragma once
/// \file
/// Standard error, which may take nothing for a while: a terminal that is stopped, or a pipe that nobody
/// reads.

#include "logging/log.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>

namespace spdlog {
class async_logger;
namespace details {
class thread_pool;
}
}  // namespace spdlog

namespace sonopose::logging {

/// How long a process that ends waits for a standard error that takes nothing.
inline constexpr std::chrono::milliseconds write_timeout{1000};

/// Writes to standard error. One thread.
class ErrorWriter {
public:
  /// Writes everything, or gives up after `write_timeout` once the process is ending.
  void write(std::string_view text);

  /// From now on a standard error that takes nothing is not waited for. From any thread.
  void end() { ending_ = true; }

private:
  std::atomic<bool> ending_ = false;
  bool gave_up_ = false;
};

/// Writes a line on the calling thread.
void write_at_once(Level level, std::string_view text);

/// Writes lines on a thread of its own, which waits for standard error.
class StandardError {
public:
  /// `capacity`: lines that may wait; the oldest are dropped for newer ones. Throws std::runtime_error if
  /// there is no thread.
  explicit StandardError(std::size_t capacity);
  StandardError(const StandardError&) = delete;
  StandardError& operator=(const StandardError&) = delete;
  /// Writes the lines that wait. Gives up after `write_timeout` in which standard error took none.
  ~StandardError();

  /// Never waits. Thread-safe, as the following.
  void write(Level level, std::string_view text);

  /// Lines that were dropped for newer ones. The log reports them too, when it can be written again.
  [[nodiscard]] std::size_t dropped() const;

  using FlushNumber = std::uint32_t;  ///< of a request; it wraps around

  /// A new request to write the lines up to a place that flush() marks.
  FlushNumber next_flush();

  /// The lines before this call belong to the request.
  void flush(FlushNumber number);

  /// Returns when the lines of the request are written, or after `write_timeout`.
  void wait_for_flush(FlushNumber number);

private:
  struct Flushes {
    std::mutex mutex;  // guards the rest
    std::condition_variable changed;
    FlushNumber requested = 0;
    FlushNumber finished = 0;
  };
  class Sink;

  Flushes flushes_;
  std::shared_ptr<spdlog::details::thread_pool> pool_;
  std::shared_ptr<Sink> sink_;
  std::shared_ptr<spdlog::async_logger> logger_;
};

}  // namespace sonopose::logging
