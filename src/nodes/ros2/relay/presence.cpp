#include "ros2/relay/presence.hpp"

namespace sonopose::ros2::relay {

void Presence::update(const observation::BeaconView& view, bool has_bridge, SteadyTime now) {
  const bool has_samples =
      has_bridge && view.bridge->imu_rate_hz + view.bridge->fix_rate_hz + view.bridge->heading_rate_hz > 0;
  if (has_samples || view.poses + view.predicted > 0) active_at_ = now;
}

Presence::State Presence::state(SteadyTime now) const {
  const TimeNs silence_ns = now - active_at_;
  if (silence_ns > limits_.gone_after_ns) return State::gone;
  return silence_ns > limits_.stale_after_ns ? State::stale : State::present;
}

}  // namespace sonopose::ros2::relay
