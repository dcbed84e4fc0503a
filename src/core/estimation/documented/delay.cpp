#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/estimation/documented/delay.hpp>

namespace sonopose::estimation::documented::delay {
void extrapolate_to_now(const DelaySettings& settings, const Kinematics& body, TimedFix& fix) {
  fix.shifted_position_world_m = fix.measured_position_world_m;
  if (!settings.extrapolate || !body.started()) return;
  // If the history begins later, use the current velocity.
  fix.shifted_position_world_m +=
      body.displacement_between(fix.measured_ns, body.time_ns)
          .value_or(body.velocity_world_mps * seconds_between(fix.measured_ns, body.time_ns));
}

TimedFix extrapolated(const DelaySettings& settings, const Kinematics& body, const UltrasonicFix& fix) {
  TimedFix timed{aiding::measured_at(settings, fix), fix.position_world_m, fix.position_world_m,
                 Vector3d::Ones()};
  extrapolate_to_now(settings, body, timed);
  return timed;
}

}  // namespace sonopose::estimation::documented::delay
