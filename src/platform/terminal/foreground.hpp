#pragma once
/// \file
/// Finds out if a program may change its terminal.

#include <unistd.h>

namespace sonopose::terminal {

/// Returns true if another program has the terminal: a change would then stop this program. A terminal that
/// is not the controlling one stops nobody. Async-signal-safe.
inline bool is_in_background(int terminal_fd) noexcept {
  const pid_t foreground = ::tcgetpgrp(terminal_fd);
  return foreground >= 0 && foreground != ::getpgrp();
}

}  // namespace sonopose::terminal
