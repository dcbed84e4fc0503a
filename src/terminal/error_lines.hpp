#pragma once
/// \file
/// Standard error while a screen is shown: text of any library would destroy the screen.

#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::terminal {

/// Takes the place of standard error: what any thread writes becomes lines here. If standard error is not a
/// terminal, each line is passed on at once. Otherwise the destructor writes them, at most the last 1000.
class ErrorLines {
public:
  /// Throws std::system_error.
  ErrorLines();
  ErrorLines(const ErrorLines&) = delete;
  ErrorLines& operator=(const ErrorLines&) = delete;
  /// Puts standard error back.
  ~ErrorLines();

  /// The original standard error.
  [[nodiscard]] int original_fd() const { return original_fd_; }

  /// The complete lines since the last call.
  std::vector<std::string> take();

private:
  static constexpr std::size_t most_lines = 1000;
  static constexpr std::size_t most_columns = 1000;  ///< bytes of a line; the rest is left out

  void read_lines();
  void add(const std::string& line);

  int original_fd_ = -1;
  int read_fd_ = -1;
  bool on_terminal_ = false;
  std::mutex mutex_;                    // guards the rest
  std::vector<std::string> new_lines_;  ///< for take()
  std::deque<std::string> kept_;        ///< for the end
  std::size_t dropped_ = 0;             ///< of `kept_`
  std::thread reader_;
};

}  // namespace sonopose::terminal
