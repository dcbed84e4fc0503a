#pragma once
/// \file
/// The autopilot at the other end of the line, by its heartbeats.

#include "mavlink/frame.hpp"
#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::mavlink::sender {

/// An autopilot by its heartbeats. The first one that is heard, until it is silent. Not thread-safe.
class HeartbeatTracker {
public:
  /// Heartbeats come once a second.
  static constexpr TimeNs lost_after_ns = 5'000'000'000;

  /// Returns true for a heartbeat of this autopilot.
  bool on(const Frame& frame, SteadyTime now);

  /// Kind of the autopilot (MAV_AUTOPILOT); empty without heartbeats.
  [[nodiscard]] std::optional<std::uint8_t> kind(SteadyTime now) const;

  /// Our identity: a component of its vehicle.
  [[nodiscard]] Identity own() const;

private:
  Identity autopilot_;
  std::uint8_t kind_ = 0;
  std::optional<SteadyTime> heard_;
};

}  // namespace sonopose::mavlink::sender
