// Silence of the IMU: the motion is unknown, and only fixes and headings show it.

#include "estimation/kalman/state_internal.hpp"

namespace sonopose::estimation::kalman {
namespace {

void predict_without_imu_to(State& state, TimeNs to_ns) {
  const double duration_s = seconds_between(state.time_ns, to_ns);
  if (duration_s <= 0.0) return;
  state.propagate();
  state.time_ns = to_ns;
  for (Hypothesis& each : state.bank) each.filter.predict_without_imu(duration_s, UnknownMotion{});
}

}  // namespace

void predict_if_silent(State& state, const settings::Settings& settings, TimeNs measured_ns) {
  const TimeNs sample_ns = state.imu.time_ns;
  const bool is_silent = seconds_between(sample_ns, measured_ns) > settings.outage.imu_gap_s;
  if (!is_silent) return;
  if (seconds_between(sample_ns, state.headings.used_ns) < settings.outage.imu_gap_s) {
    state.headings.is_current = false;  // measured before the silence
  }
  if (measured_ns <= state.time_ns) return;
  rest::restart(state.rest);
  predict_without_imu_to(state, measured_ns);
}

/// Handles the first sample after the silence.
void end_imu_gap(State& state, TimeNs to_ns) {
  constexpr double unknown_yaw_rad = radians(30.0);
  predict_without_imu_to(state, to_ns);
  if (state.filter().yaw_variance_rad2() > square(unknown_yaw_rad)) search_yaw_again(state);
  rest::restart(state.rest);
  state.frozen_track = {};
}

}  // namespace sonopose::estimation::kalman
