#pragma once
// Shows the progress of a program.

#include <chrono>
#include <string_view>

namespace sonopose::apps {

/// A line on standard error that replaces itself: a bar, the completed share and the current step. Appears
/// only on a terminal, and after two seconds.
class Progress {
public:
  Progress();
  /// Removes the line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `share`: 0 … 1, or NaN if unknown, which shows no bar.
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
