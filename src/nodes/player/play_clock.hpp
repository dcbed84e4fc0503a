#pragma once
/// \file
/// Due times of the messages of a recording.

#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::player {

/// Recorded time at a multiple of real time, with pauses. Not thread-safe.
class PlayClock {
public:
  /// `rate`: 1 is real time, 10 is ten times as fast, 0 is as fast as possible. Throws std::invalid_argument
  /// if it is negative or not finite.
  explicit PlayClock(double rate);

  /// Starts playing at `log_time_ns` of the recording.
  void begin(std::uint64_t log_time_ns, SteadyTime now);

  /// Due time of that time of the recording; empty during a pause.
  [[nodiscard]] std::optional<SteadyTime> due(std::uint64_t log_time_ns) const;

  /// Lets the times after the current one be due earlier, as if the recording lacked this duration.
  void leave_out(std::uint64_t duration_ns) { log_time_ns_ += duration_ns; }

  void pause(SteadyTime now);
  void resume(SteadyTime now);
  /// Plays a message during a pause; a later `resume` continues from its time.
  void step_to(std::uint64_t log_time_ns);
  [[nodiscard]] bool is_paused() const { return paused_at_.has_value(); }

private:
  double rate_;
  std::uint64_t log_time_ns_ = 0;  ///< recorded time that is played at `at_`
  SteadyTime at_;
  std::optional<SteadyTime> paused_at_;
};

}  // namespace sonopose::player
