#pragma once
/// \file
/// Restores the terminal when the process crashes, with nothing but async-signal-safe calls.

#include <string>
#include <string_view>

namespace sonopose::terminal {

/// At most one at a time: signal handlers are global.
class CrashRestore {
public:
  /// From now on, crash signals and std::terminate restore the present line modes of `terminal_fd`, make
  /// `error_fd` standard error again, and continue as before. Throws std::system_error.
  CrashRestore(int terminal_fd, int error_fd);
  CrashRestore(const CrashRestore&) = delete;
  CrashRestore& operator=(const CrashRestore&) = delete;
  /// Puts the earlier handlers back.
  ~CrashRestore();

  /// What the handler writes to standard error after the restore: the end of what was kept, and what is still
  /// in the pipe `fd`; -1: no pipe.
  static void read_from(int fd) noexcept;
  /// Only from one thread at a time.
  static void keep(std::string_view text) noexcept;

  /// What a crash does to the terminal and to standard error, for another sudden end. Async-signal-safe; does
  /// nothing without an object of this class.
  static void restore_now() noexcept;

  /// On a crash, `sequence` (at most 512 bytes) is written to the terminal first.
  static void leave_with(const std::string& sequence);
};

/// Lets the crash signals of the calling thread through. Cyclone DDS blocks all signals in its threads, and a
/// blocked fault ends the process without a handler. Cheap after the first call of a thread.
void unblock_crash_signals() noexcept;

}  // namespace sonopose::terminal
