#pragma once
/// \file
/// The autopilot at the other end of the line, by its heartbeats.

#include "mavlink/frame.hpp"
#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::mavlink::sender {

/// An autopilot by its heartbeats: the first one that is heard, from its port, until it is silent. Another
/// program of its machine can send as the same system. Not thread-safe.
class HeartbeatTracker {
public:
  /// Heartbeats come once a second.
  static constexpr TimeNs lost_after_ns = 5'000'000'000;

  /// Returns true for a heartbeat of this autopilot. `port`: sender of the datagram; 0 on other lines.
  bool on(const Frame& frame, std::uint16_t port, SteadyTime now);

  /// True for a frame of this autopilot.
  [[nodiscard]] bool has_sent(const Frame& frame, std::uint16_t port) const;

  /// Kind of the autopilot (MAV_AUTOPILOT); empty without heartbeats.
  [[nodiscard]] std::optional<std::uint8_t> kind(SteadyTime now) const;

  /// Our identity: a component of its vehicle.
  [[nodiscard]] Identity own() const;

private:
  Identity autopilot_;
  std::uint16_t port_ = 0;
  std::uint8_t kind_ = 0;
  std::optional<SteadyTime> heard_;
};

}  // namespace sonopose::mavlink::sender
