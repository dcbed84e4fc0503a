#pragma once
/// \file
/// Detects an open line that delivers no frames.

#include "logging/bounded_log.hpp"
#include <sonopose/samples/status.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace sonopose::bridge {

/// Detects bytes that are no frames, and silence, on the line of a bridge. Not thread-safe.
class LineFaultDetector {
public:
  /// Advice for bytes without a valid frame.
  struct Advice {
    std::string unknown;  ///< for bytes of no known kind, such as "check --baud (now 115200)"
    std::string foreign;  ///< for another protocol, or text
  };

  explicit LineFaultDetector(Advice advice) : advice_(std::move(advice)) {}

  /// Keeps the latest bytes, to recognise what they are.
  void on_bytes(std::span<const std::uint8_t> bytes);

  /// Sets state and text of an open line that is silent or delivers no frames. Logs each change. Call it
  /// several times a second.
  void judge(LineStatus& line, SteadyTime now);

  /// The line's log, for its other changes.
  [[nodiscard]] logging::BoundedLog& log() { return log_; }

private:
  /// Amount delivered, and the time of its last increase.
  struct Progress {
    std::uint64_t count = 0;
    SteadyTime since;
  };

  void begin(SteadyTime now);
  [[nodiscard]] std::string advice() const;
  void log_change(const LineStatus& line, SteadyTime now);

  Advice advice_;
  std::array<std::uint8_t, 2048> latest_{};  ///< several sentences or messages of other protocols
  std::size_t latest_size_ = 0;
  bool is_open_ = false;
  Progress bytes_;
  Progress frames_;
  std::uint64_t bytes_at_frame_ = 0;  ///< bytes received up to the last frame
  LineState logged_ = LineState::open;
  /// Bound for a device that comes and goes.
  static constexpr std::uint64_t max_lines_per_minute = 8;
  logging::BoundedLog log_{max_lines_per_minute};
};

}  // namespace sonopose::bridge
