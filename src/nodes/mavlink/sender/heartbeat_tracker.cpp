#include "mavlink/sender/heartbeat_tracker.hpp"

#include "mavlink/messages.hpp"

namespace sonopose::mavlink::sender {

bool HeartbeatTracker::on(const Frame& frame, std::uint16_t port, SteadyTime now) {
  const auto heard = autopilot_of(frame);
  if (!heard || (kind(now) && !has_sent(frame, port))) return false;
  autopilot_ = frame.sender;
  port_ = port;
  kind_ = *heard;
  heard_ = now;
  return true;
}

bool HeartbeatTracker::has_sent(const Frame& frame, std::uint16_t port) const {
  return heard_ && frame.sender == autopilot_ && port == port_;
}

std::optional<std::uint8_t> HeartbeatTracker::kind(SteadyTime now) const {
  if (!heard_ || now - *heard_ > lost_after_ns) return std::nullopt;
  return kind_;
}

Identity HeartbeatTracker::own() const {
  return {autopilot_.system, own_component};
}

}  // namespace sonopose::mavlink::sender
