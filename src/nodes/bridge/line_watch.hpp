#pragma once
/// \file
/// Detects an open line that delivers no frames.

#include "transitions/bounded_log.hpp"
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace sonopose::bridge {

class LineWatch {
public:
  /// `check`: advice for bytes without a valid frame, such as "--baud (now 115200)".
  explicit LineWatch(std::string check) : check_(std::move(check)) {}

  /// Sets state and text of an open line that is silent or delivers no frames. Logs each change. Call it
  /// several times a second.
  void judge(LineStatus& line, SteadyTime now);

  /// The line's log, for its other changes.
  [[nodiscard]] transitions::BoundedLog& log() { return log_; }

private:
  /// Amount delivered, and the time of its last increase.
  struct Progress {
    std::uint64_t count = 0;
    SteadyTime since;
  };

  void begin(SteadyTime now);
  void log_change(const LineStatus& line, SteadyTime now);

  std::string check_;
  bool is_open_ = false;
  Progress bytes_;
  Progress frames_;
  std::uint64_t bytes_at_frame_ = 0;  ///< bytes received up to the last frame
  LineState logged_ = LineState::open;
  /// Bound for a device that comes and goes.
  static constexpr std::uint64_t max_lines_per_minute = 8;
  transitions::BoundedLog log_{max_lines_per_minute};
};

}  // namespace sonopose::bridge
