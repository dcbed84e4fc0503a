#pragma once
/// \file
/// Restores the terminal when the process crashes, using only async-signal-safe calls.

#include <string>
#include <string_view>

namespace sonopose::terminal {

/// The crash handlers. At most one object at a time: signal handlers are global.
class CrashRestore {
public:
  /// Sets the handlers of crash signals and std::terminate. They restore the current line modes of
  /// `terminal_fd`, make `error_fd` standard error again, and continue as before. Throws std::system_error.
  CrashRestore(int terminal_fd, int error_fd);
  CrashRestore(const CrashRestore&) = delete;
  CrashRestore& operator=(const CrashRestore&) = delete;
  /// Restores the earlier handlers.
  ~CrashRestore();

  /// Sets the pipe whose rest the handler writes to standard error after the restore, following the kept
  /// text; -1: no pipe.
  static void read_from(int fd) noexcept;
  /// Keeps text for the handler. One thread at a time.
  static void keep(std::string_view text) noexcept;

  /// Restores the terminal and standard error as a crash does, for another sudden end. Async-signal-safe;
  /// does nothing without an object of this class.
  static void restore_now() noexcept;

  /// Sets the `sequence` (at most 512 bytes) that a crash writes to the terminal first.
  static void leave_with(const std::string& sequence);
};

/// Unblocks the crash signals of the calling thread. Cyclone DDS blocks all signals in its threads, and a
/// blocked fault ends the process without a handler. Cheap after the first call of a thread.
void unblock_crash_signals() noexcept;

}  // namespace sonopose::terminal
