#include <sonopose/estimation/documented/outage.hpp>

#include <cmath>

namespace sonopose::estimation::documented::outage {

bool is_imu_gap(const OutageSettings& settings, double dt_s) {
  return dt_s > settings.imu_gap_s;
}

bool is_recent(const OutageSettings& settings, TimeNs then_ns, TimeNs now_ns) {
  return seconds_between(then_ns, now_ns) <= settings.stale_after_s;
}

bool update(const OutageSettings& settings, OutageState& state, TimeNs now_ns) {
  if (state.last_valid_fix_ns == 0) return false;
  state.stale = !is_recent(settings, state.last_valid_fix_ns, now_ns);
  if (state.stale) state.init_phase = InitPhase::no_position;
  return state.stale;
}

void decay(const OutageSettings& settings, Kinematics& body, double dt_s) {
  body.velocity_world_mps *= std::exp(-settings.velocity_decay_rate_hz * dt_s);
}

}  // namespace sonopose::estimation::documented::outage
