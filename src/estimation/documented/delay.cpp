#include <sonopose/estimation/documented/delay.hpp>

namespace sonopose::estimation::documented::delay {
namespace {

/// 0, which is no valid time, if there is no earlier time.
TimeNs before(TimeNs time_ns, double seconds) {
  return time_ns > to_ns(seconds) ? saturated_sum(time_ns, -to_ns(seconds)) : 0;
}

}  // namespace

TimeNs measured_at(const DelaySettings& settings, const UltrasonicFix& fix) {
  const bool own = settings.source == DelaySource::measured && fix.measured_delay_s.has_value();
  return own ? before(fix.emission_time_ns, settings.correction_s)
             : before(fix.received_time_ns, settings.processing_s);
}

TimeNs measured_at(const DelaySettings& settings, const PairHeading& heading) {
  const bool own = settings.source == DelaySource::measured;
  return own ? before(heading.emission_time_ns, settings.correction_s)
             : before(heading.received_time_ns, settings.processing_s);
}

void extrapolate_to_now(const DelaySettings& settings, const Kinematics& body, TimedFix& fix) {
  fix.shifted_position_world_m = fix.measured_position_world_m;
  if (!settings.extrapolate || !body.started()) return;
  // If the history begins later, use the present velocity.
  fix.shifted_position_world_m +=
      body.moved(fix.measured_ns, body.time_ns)
          .value_or(body.velocity_world_mps * seconds_between(fix.measured_ns, body.time_ns));
}

TimedFix shift(const DelaySettings& settings, const Kinematics& body, const UltrasonicFix& fix) {
  TimedFix timed{measured_at(settings, fix), fix.position_world_m, fix.position_world_m, Vector3d::Ones()};
  extrapolate_to_now(settings, body, timed);
  return timed;
}

}  // namespace sonopose::estimation::documented::delay
