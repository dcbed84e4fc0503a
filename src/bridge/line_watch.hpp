#pragma once
/// \file
/// Whether an open line delivers frames.

#include "transitions/bounded_log.hpp"
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace sonopose::bridge {

class LineWatch {
public:
  /// `check`: what the user can check if bytes arrive without a valid frame, such as "--baud (now 115200)".
  explicit LineWatch(std::string check) : check_(std::move(check)) {}

  /// Sets the state and the text of an open line that is silent or delivers no frames, and logs each change.
  /// Call it several times a second.
  void judge(LineStatus& line, SteadyTime now);

  /// The log of the line, for its other changes.
  [[nodiscard]] transitions::BoundedLog& log() { return log_; }

private:
  /// What the line had delivered, and when.
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
  std::uint64_t bytes_at_frame_ = 0;  ///< bytes received at the last frame
  LineState logged_ = LineState::open;
  /// A device that comes and goes would fill the log.
  static constexpr std::uint64_t most_lines_per_minute = 8;
  transitions::BoundedLog log_{most_lines_per_minute};
};

}  // namespace sonopose::bridge
