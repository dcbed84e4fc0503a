#pragma once
/// \file
/// Lines to a pipe whose reader may be slow or gone.

#include "process/stop_signal.hpp"

#include <string>
#include <string_view>

namespace sonopose::monitor::echo {

/// Complete lines, at once. A slow reader is waited for, until the stop.
class LineOutput {
public:
  LineOutput(int fd, const process::StopSignal& stop) : fd_(fd), stop_(stop) {}

  /// Writes one line or several, each with its newline. False if the reader is gone or the stop came. Throws
  /// std::system_error for any other reason, such as a full disk.
  bool write(std::string_view lines);

  /// Whether no process reads what would be written.
  [[nodiscard]] bool is_closed() const;

private:
  int fd_;
  const process::StopSignal& stop_;
};

}  // namespace sonopose::monitor::echo
