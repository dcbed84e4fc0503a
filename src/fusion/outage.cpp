#include <sonopose/fusion/outage.hpp>

#include <cmath>

namespace sonopose::fusion::outage {

bool watch(const OutageSettings& settings, OutageState& state, TimeNs now_ns) {
  if (state.last_valid_fix_ns == 0) return false;
  state.stale = seconds_between(state.last_valid_fix_ns, now_ns) > settings.stale_after_s;
  if (state.stale) state.track = Track::none;
  return state.stale;
}

void decay(const OutageSettings& settings, Kinematics& body, double dt_s) {
  body.velocity_world_mps *= std::exp(-settings.velocity_decay_rate_hz * dt_s);
}

}  // namespace sonopose::fusion::outage
