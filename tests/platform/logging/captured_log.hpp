#pragma once
/// \file
/// Lines of the log as standard error and as a listener receive them.

#include "logging/log.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <string>
#include <sys/ioctl.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sonopose::logging::test {

/// Standard error of this process as a pipe.
class CapturedError {
public:
  CapturedError() {
    int ends[2] = {-1, -1};
    REQUIRE(::pipe(ends) == 0);
    before_ = ::dup(STDERR_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[1]);
    read_end_ = ends[0];
  }
  CapturedError(const CapturedError&) = delete;
  CapturedError& operator=(const CapturedError&) = delete;
  ~CapturedError() {
    restore();
    close_reader();
  }

  /// Simulates a reader that goes away.
  void close_reader() {
    if (read_end_ >= 0) ::close(read_end_);
    read_end_ = -1;
  }

  /// Restores standard error; afterwards read() ends.
  void restore() {
    if (before_ < 0) return;
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
    before_ = -1;
  }

  /// Writes until the pipe is full; returns the number of bytes.
  static std::size_t fill() {
    ::fcntl(STDERR_FILENO, F_SETPIPE_SZ, 4096);
    const int flags = ::fcntl(STDERR_FILENO, F_GETFL);
    ::fcntl(STDERR_FILENO, F_SETFL, flags | O_NONBLOCK);
    std::size_t written = 0;
    while (::write(STDERR_FILENO, "x", 1) == 1) ++written;
    ::fcntl(STDERR_FILENO, F_SETFL, flags);
    return written;
  }

  /// Bytes written but not yet read.
  [[nodiscard]] int waiting() const {
    int bytes = 0;
    ::ioctl(read_end_, FIONREAD, &bytes);
    return bytes;
  }

  /// Reads at least `size` bytes, or everything until no writer is left.
  std::string read(std::size_t size = SIZE_MAX) const {
    std::string text;
    char buffer[4096];
    while (text.size() < size) {
      const ssize_t got = ::read(read_end_, buffer, sizeof buffer);
      if (got <= 0) break;
      text.append(buffer, static_cast<std::size_t>(got));
    }
    return text;
  }

private:
  int before_ = -1;
  int read_end_ = -1;
};

/// Stores the lines that it receives.
class Collector final : public logging::Listener {
public:
  void on(const logging::Line& line) noexcept override {
    texts.emplace_back(line.text);
    times_ns.push_back(line.time_ns);
    levels.push_back(line.level);
    thread = std::this_thread::get_id();
    ++count;
  }

  std::vector<std::string> texts;
  std::vector<std::int64_t> times_ns;
  std::vector<logging::Level> levels;
  std::thread::id thread;
  std::atomic<std::size_t> count = 0;  ///< readable while listening
};

}  // namespace sonopose::logging::test
