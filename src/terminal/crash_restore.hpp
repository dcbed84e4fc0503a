#pragma once
/// \file
/// Restores the terminal when the process crashes, with nothing but async-signal-safe calls.

#include <string>

namespace sonopose::terminal {

/// At most one at a time: signal handlers are global.
class CrashRestore {
public:
  /// From now on crash signals and std::terminate give `terminal_fd` its line modes of this moment back, put
  /// `error_fd` in the place of standard error, and continue as before. Throws std::system_error.
  CrashRestore(int terminal_fd, int error_fd);
  CrashRestore(const CrashRestore&) = delete;
  CrashRestore& operator=(const CrashRestore&) = delete;
  /// Puts the earlier handlers back.
  ~CrashRestore();

  /// And they write `sequence`, at most 512 bytes, to the terminal.
  static void leave_with(const std::string& sequence);
};

}  // namespace sonopose::terminal
