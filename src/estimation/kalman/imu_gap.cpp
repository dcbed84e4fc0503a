// A silence of the IMU: the motion is unknown, and only fixes and headings show it.

#include "estimation/kalman/belief_parts.hpp"

namespace sonopose::estimation::kalman {

/// Moves the filters to a time without a sample.
void Belief::coast_to(TimeNs to_ns) {
  const double duration_s = seconds_between(state_ns, to_ns);
  state_ns = to_ns;
  propagate();
  for_each_filter([&](Filter& each, const ProcessNoise&) { each.coast(duration_s, UnknownMotion{}); });
}

/// Moves the filters to a measurement, if the IMU has been silent before it.
void Belief::coast_if_silent(const settings::Settings& settings, TimeNs measured_ns) {
  const bool is_silent = seconds_between(time_ns, measured_ns) > settings.outage.imu_gap_s;
  if (!is_silent) return;
  const bool heading_is_older = seconds_between(time_ns, last_heading_ns) < settings.outage.imu_gap_s;
  if (heading_is_older) heading_is_current = false;  // measured before the silence
  if (measured_ns <= state_ns) return;
  rest::restart(rest);
  coast_to(measured_ns);
}

/// The first sample after the silence.
void Belief::end_imu_gap(TimeNs to_ns) {
  constexpr double unknown_yaw_rad = radians(30.0);
  coast_to(to_ns);
  if (filter().yaw_variance_rad2() > square(unknown_yaw_rad)) restart_pending = true;
  rest::restart(rest);
  repetition = Repetition{};
}

}  // namespace sonopose::estimation::kalman
