#pragma once
/// \file
/// Limits how often lines of one kind are logged: a stranger on the network can cause some without end.

#include "logging/log.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::logging {

/// Returns what lines of one kind have in common: each word with a digit is replaced by "#". At most 128
/// bytes.
std::string kind_of(std::string_view text);

/// Admits some lines of each kind in a minute, counts the others, and reports them with the latest one at the
/// end of the minute. A kind that was over its limit has only that one line a minute, until it stays within
/// the limit for a minute. Keeps a bounded number of kinds; further ones share a limit. Levels debug and
/// failure have no limits. Not thread-safe.
class LineLimit {
public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds window{60};
  static constexpr std::size_t max_kinds = 256;
  static constexpr std::size_t max_of_kind = 60;
  /// Lines of one kind that begin with "beacon ". They are limited for each beacon too, and 256 beacons are
  /// no attack.
  static constexpr std::size_t max_of_beacons = 600;
  static constexpr std::size_t max_of_all = 1000;
  static constexpr std::size_t max_latest_bytes = 1024;  ///< longer latest lines are shortened

  struct Admitted {
    Level level;
    std::string text;
  };

  /// Returns the lines to log now: the reports that are due, then this line unless it is over a limit.
  std::vector<Admitted> admitted(Level level, std::string_view text, Time now);

  /// Returns the reports that are due without another line.
  std::vector<Admitted> due(Time now);

  /// Returns the reports that are pending, at the end of the log.
  std::vector<Admitted> finish();

private:
  /// Lines of a window.
  struct Count {
    bool admits(std::size_t max, Time now);
    [[nodiscard]] bool is_over(Time now) const { return now - began >= window; }

    Time began;
    std::size_t lines = 0;
    std::uint64_t left_out = 0;
  };
  struct Kind {
    Count count;
    Level level = Level::info;
    std::string latest;  ///< latest line that was left out
  };

  Kind& kind(const std::string& name, bool is_serious, Time now);
  void report_due(Time now, std::vector<Admitted>& lines);

  std::map<std::string, Kind> kinds_;
  std::array<Count, 2> all_;  ///< infos; warnings and errors, which a flood of infos must not displace
};

}  // namespace sonopose::logging
