#pragma once
// How far a program is.

#include <chrono>
#include <string_view>

namespace sonopose::apps {

/// One line on standard error that replaces itself: a bar, the share that is done and what is being done.
/// Only on a terminal, and only in programs that take more than two seconds.
class Progress {
public:
  Progress();
  /// Removes the line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  Progress(Progress&&) = delete;
  Progress& operator=(Progress&&) = delete;

  /// `share` is 0 … 1, or NaN if it is not known: then there is no bar.
  void at(double share, std::string_view what);
  /// Removes the line before other output.
  void clear();

private:
  using Clock = std::chrono::steady_clock;

  bool is_terminal_;
  bool is_drawn_ = false;
  Clock::time_point due_;
};

}  // namespace sonopose::apps
