#include "mavlink/sender/autopilot_watch.hpp"

#include "mavlink/messages.hpp"

namespace sonopose::mavlink::sender {

bool AutopilotWatch::on(const Frame& frame, SteadyTime now) {
  const auto heard = autopilot_of(frame);
  if (!heard || (kind(now) && frame.sender != autopilot_)) return false;
  autopilot_ = frame.sender;
  kind_ = *heard;
  heard_ = now;
  return true;
}

std::optional<std::uint8_t> AutopilotWatch::kind(SteadyTime now) const {
  if (!heard_ || now - *heard_ > lost_after_ns) return std::nullopt;
  return kind_;
}

Identity AutopilotWatch::own() const {
  return {autopilot_.system, own_component};
}

}  // namespace sonopose::mavlink::sender
