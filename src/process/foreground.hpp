#pragma once
/// \file
/// Whether a program may change its terminal.

#include <unistd.h>

namespace sonopose::process {

/// Whether another program has the terminal now: it stops this one for a change. A terminal that is not the
/// controlling one stops nobody. Async-signal-safe.
inline bool is_in_background(int terminal_fd) noexcept {
  const pid_t foreground = ::tcgetpgrp(terminal_fd);
  return foreground >= 0 && foreground != ::getpgrp();
}

}  // namespace sonopose::process
