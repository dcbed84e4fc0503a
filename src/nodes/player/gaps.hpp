#pragma once
/// \file
/// Times of a recording without a message, such as at a step of the host's clock.

#include <cstdint>
#include <optional>

namespace sonopose::player {

/// Shortens gaps, and logs those that let a user wait. Not thread-safe.
class Gaps {
public:
  /// `max_gap_s`: longer gaps are shortened to it; empty: none is. `rate`: as of PlayClock. `begin_ns`: first
  /// log time of the recording. Throws std::invalid_argument if the gap is negative or not finite.
  Gaps(std::optional<double> max_gap_s, double rate, std::uint64_t begin_ns);

  /// Starts a run at a message of this log time.
  void begin(std::uint64_t log_time_ns) { last_ns_ = log_time_ns; }

  /// Advances to the next message. Returns the duration to leave out before it.
  std::uint64_t advance_to(std::uint64_t log_time_ns);

  [[nodiscard]] std::uint64_t shortened() const { return shortened_; }
  [[nodiscard]] double left_out_s() const { return left_out_s_; }

private:
  void log(double gap_s, bool is_shortened);

  std::optional<double> max_gap_s_;
  double rate_;
  std::uint64_t begin_ns_;
  std::uint64_t last_ns_ = 0;
  std::uint64_t shortened_ = 0;
  double left_out_s_ = 0;
  int logged_ = 0;
};

}  // namespace sonopose::player
