#pragma once
/// \file
/// What programs write to standard error.

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

namespace sonopose::launch {

enum class ErrorOutput : std::uint8_t {
  pass_on,  ///< they write to the standard error of this process
  keep,     ///< the latest lines, printed at the end: for programs behind a full screen
};

/// The lines of one program. Kept lines are bounded: the oldest are dropped and counted, and long ones are
/// cut.
class ErrorLines {
public:
  static constexpr std::size_t most_lines = 1000;
  static constexpr std::size_t most_columns = 1000;

  void add(std::string_view bytes);
  /// Prints what was kept, and a last line without an end.
  void print_kept();

  [[nodiscard]] const std::deque<std::string>& kept() const { return kept_; }
  [[nodiscard]] std::size_t dropped() const { return dropped_; }

private:
  void end_line();

  std::string unfinished_;
  std::deque<std::string> kept_;
  std::size_t dropped_ = 0;
};

}  // namespace sonopose::launch
