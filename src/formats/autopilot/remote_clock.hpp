#pragma once
/// \file
/// The clock of the stamps that an autopilot expects, from messages that it stamps when it sends them.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace sonopose::autopilot {

/// Offset of the autopilot's stamps to the host's clock. Messages can be late but never early, so the largest
/// of the last offsets is the best. Not thread-safe.
class RemoteClock {
public:
  /// Silence after which the clock is lost. PX4 sends a message a second.
  static constexpr TimeNs lost_after_ns = 3'000'000'000;
  /// Stamps at most this far behind count as late stamps of the host's clock: PX4's client converts stamps
  /// to the clock of the agent's machine. That ends at twice this. Stamps ahead belong to another clock.
  static constexpr TimeNs same_clock_ns = 50'000'000;

  /// Takes a stamp, with the time of its arrival. One that differs from the others by more than 0.5 s
  /// discards them: a clock was set, or the autopilot restarted.
  void on(TimeNs stamp_ns, HostTime arrival, SteadyTime now);

  /// Converts a time of the host. Empty while the clock is not known.
  [[nodiscard]] std::optional<TimeNs> at(HostTime time, SteadyTime now) const;

private:
  static constexpr std::size_t window = 10;

  std::array<TimeNs, window> offsets_ns_{};
  std::size_t count_ = 0;  ///< messages since its start
  TimeNs offset_ns_ = 0;
  bool is_same_clock_ = false;
  SteadyTime last_;
};

}  // namespace sonopose::autopilot
