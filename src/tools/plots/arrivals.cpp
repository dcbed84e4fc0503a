#include "plots/arrivals.hpp"

#include "plots/thinned.hpp"

#include <cmath>
#include <limits>

namespace sonopose::plots {
namespace {

void merge(ArrivalMark& into, const ArrivalMark& next) {
  into.time_s = next.time_s;
  if (std::abs(next.delay_s) > std::abs(into.delay_s)) into.delay_s = next.delay_s;
  into.quality_percent = std::fmin(into.quality_percent, next.quality_percent);
}

}  // namespace

Arrivals arrivals_of(const recording::SensorLog& log) {
  const TimeNs begin_ns = log.events.empty() ? 0 : available_at_ns(log.events.front());
  Thinned<HeadingMark> headings(Arrivals::max_marks,
                                [](HeadingMark& into, const HeadingMark& next) { into = next; });
  Thinned<ArrivalMark> fixes(Arrivals::max_marks, merge);
  for (const Event& event : log.events) {
    if (const auto* heading = std::get_if<PairHeading>(&event)) {
      if (!heading->valid) continue;
      headings.add({seconds_between(begin_ns, heading->emission_time_ns), heading->heading_world_rad,
                    (heading->flags & heading_flag_of_body) != 0});
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      fixes.add({seconds_between(begin_ns, fix->received_time_ns),
                 seconds_between(fix->emission_time_ns, fix->received_time_ns),
                 fix->quality_percent.value_or(std::numeric_limits<double>::quiet_NaN())});
    }
  }
  return {headings.entries(), fixes.entries()};
}

}  // namespace sonopose::plots
