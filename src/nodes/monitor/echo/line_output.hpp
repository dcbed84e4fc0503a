#pragma once
/// \file
/// Writes lines to a pipe whose reader may be slow or gone.

#include "process/stop_signal.hpp"

#include <string_view>

namespace sonopose::monitor::echo {

/// Writes complete lines immediately. Waits for a slow reader until the stop.
class LineOutput {
public:
  LineOutput(int fd, const process::StopSignal& stop) : fd_(fd), stop_(stop) {}

  /// Writes one or several lines, each with its newline. Returns false if the reader is gone or the stop
  /// came. Throws std::system_error for any other failure, such as a full disk.
  bool write(std::string_view lines);

  /// True if no process reads the output.
  [[nodiscard]] bool is_closed() const;

private:
  int fd_;
  const process::StopSignal& stop_;
};

}  // namespace sonopose::monitor::echo
