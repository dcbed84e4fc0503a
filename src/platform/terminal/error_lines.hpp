#pragma once
/// \file
/// Collects standard error while a screen is shown: text of any library would destroy the screen.

#include "files/descriptor.hpp"
#include "threads/mutex.hpp"
#include <sonopose/text/kept_lines.hpp>

#include <string>
#include <thread>
#include <vector>

namespace sonopose::terminal {

/// Replaces standard error: text that any thread writes becomes lines here. If standard error is not a
/// terminal, each line is passed on immediately. Otherwise the destructor writes the latest lines.
class ErrorLines {
public:
  /// Throws std::system_error.
  ErrorLines();
  ErrorLines(const ErrorLines&) = delete;
  ErrorLines& operator=(const ErrorLines&) = delete;
  /// Restores standard error.
  ~ErrorLines();

  /// The original standard error.
  [[nodiscard]] int original_fd() const { return original_.number(); }

  /// The complete lines since the last call.
  std::vector<std::string> take();

private:
  void read_lines();
  void on_line(const std::string& line);

  files::Descriptor original_;
  files::Descriptor pipe_;  ///< its end to read
  bool on_terminal_ = false;
  threads::Mutex mutex_;
  std::vector<std::string> new_lines_ SONOPOSE_GUARDED_BY(mutex_);  ///< lines for take()
  text::KeptLines kept_;  ///< kept for the end; used by the reading thread, then by the destructor
  std::thread reader_;
};

}  // namespace sonopose::terminal
