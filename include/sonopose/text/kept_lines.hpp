#pragma once
/// \file
/// The latest lines of a stream of bytes.

#include <cstddef>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::text {

/// Splits bytes into lines and keeps the latest. Memory is bounded: the oldest lines are dropped and counted,
/// and long ones are cut.
class KeptLines {
public:
  static constexpr std::size_t max_lines = 1000;
  static constexpr std::size_t max_columns = 1000;  ///< largest number of bytes per line

  /// Adds bytes and calls `on_line` for each line that is now complete.
  void add(std::string_view bytes, const std::function<void(const std::string& line)>& on_line = {});

  /// Returns the kept lines, the last one possibly without an end. If earlier ones were dropped, the first
  /// line has their number.
  std::vector<std::string> take();

  [[nodiscard]] const std::deque<std::string>& lines() const { return lines_; }
  [[nodiscard]] std::size_t dropped() const { return dropped_; }

private:
  void end_line();

  std::string unfinished_;
  std::deque<std::string> lines_;
  std::size_t dropped_ = 0;
};

}  // namespace sonopose::text
