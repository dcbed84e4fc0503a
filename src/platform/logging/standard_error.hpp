#pragma once
/// \file
/// Standard error that may block for a while: a stopped terminal, or a pipe that nobody reads.

#include "logging/log.hpp"
#include "threads/mutex.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace spdlog {
class async_logger;
namespace details {
class thread_pool;
}
}  // namespace spdlog

namespace sonopose::logging {

/// Time that an ending process waits for a blocked standard error.
inline constexpr std::chrono::milliseconds write_timeout{1000};

/// Writes to standard error, on one thread.
class ErrorWriter {
public:
  /// Writes everything, or gives up after `write_timeout` once the process is ending.
  void write(std::string_view text);

  /// Stops waiting for a blocked standard error from now on. Thread-safe.
  void end() { ending_ = true; }

private:
  std::atomic<bool> ending_ = false;
  bool gave_up_ = false;
};

/// Writes a line on the calling thread.
void write_at_once(Level level, std::string_view text);

/// Writes lines on its own thread, which waits for standard error.
class StandardError {
public:
  /// `capacity`: lines that may wait; newer lines replace the oldest. Throws std::runtime_error if no thread
  /// can be created.
  explicit StandardError(std::size_t capacity);
  StandardError(const StandardError&) = delete;
  StandardError& operator=(const StandardError&) = delete;
  /// Writes the waiting lines. Gives up after `write_timeout` in which standard error took none.
  ~StandardError();

  /// Never waits. Thread-safe, like the following functions.
  void write(Level level, std::string_view text);

  /// Number of lines dropped for newer ones. The log also reports them, when it can be written again.
  [[nodiscard]] std::size_t dropped() const;

  using FlushNumber = std::uint32_t;  ///< number of a request; it wraps around

  /// Creates a request to write the lines up to a place that flush() marks.
  FlushNumber next_flush();

  /// Marks the current place: earlier lines belong to the request.
  void flush(FlushNumber number);

  /// Returns when the lines of the request are written, or after `write_timeout`.
  void wait_for_flush(FlushNumber number);

private:
  struct Flushes {
    threads::Mutex mutex;
    std::condition_variable_any changed;
    FlushNumber requested SONOPOSE_GUARDED_BY(mutex) = 0;
    FlushNumber finished SONOPOSE_GUARDED_BY(mutex) = 0;
  };
  class Sink;

  Flushes flushes_;
  std::shared_ptr<spdlog::details::thread_pool> pool_;
  std::shared_ptr<Sink> sink_;
  std::shared_ptr<spdlog::async_logger> logger_;
};

}  // namespace sonopose::logging
