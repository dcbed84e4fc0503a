#include <sonopose/estimation/aiding/delay.hpp>

namespace sonopose::estimation::aiding {
namespace {

/// An earlier time; 0, which is no valid time, if there is none.
TimeNs before(TimeNs time_ns, double seconds) {
  return time_ns > to_ns(seconds) ? saturated_sum(time_ns, -to_ns(seconds)) : 0;
}

template <class Sample>
Sample stamped(Sample sample, TimeNs time_ns) {
  sample.emission_time_ns = sample.received_time_ns = time_ns;
  return sample;
}

}  // namespace

UltrasonicFix at_arrival(const UltrasonicFix& fix, TimeNs now_ns) {
  const bool is_set = (fix.flags & ultrasonic_flag_set_pose) != 0;
  return is_set && now_ns != 0 ? stamped(fix, now_ns) : fix;
}

PairHeading at_arrival(const PairHeading& heading, TimeNs now_ns) {
  constexpr TimeNs earlier_ns = 1'000'000;  // the buffer of the Kalman engine takes it first
  const bool is_set = (heading.flags & heading_flag_set_pose) != 0;
  return is_set && now_ns != 0 ? stamped(heading, now_ns - earlier_ns) : heading;
}

TimeNs measured_at(const settings::DelaySettings& settings, const UltrasonicFix& fix) {
  if ((fix.flags & ultrasonic_flag_set_pose) != 0) return fix.emission_time_ns;
  const bool own =
      settings.source == sonopose::settings::DelaySource::measured && fix.measured_delay_s.has_value();
  return own ? before(fix.emission_time_ns, settings.correction_s)
             : before(fix.received_time_ns, settings.processing_s);
}

TimeNs measured_at(const settings::DelaySettings& settings, const PairHeading& heading) {
  if ((heading.flags & heading_flag_set_pose) != 0) return heading.emission_time_ns;
  const bool own = settings.source == sonopose::settings::DelaySource::measured;
  return own ? before(heading.emission_time_ns, settings.correction_s)
             : before(heading.received_time_ns, settings.processing_s);
}

}  // namespace sonopose::estimation::aiding
