#pragma once
/// \file
/// Detects samples that leave the bridge late because it was stopped.

#include <sonopose/samples/time.hpp>

#include <optional>
#include <utility>

namespace sonopose::fusion {

/// The backlog of a bridge. A bridge that resumes after a stop immediately sends samples that are already
/// old. Only differences of transit times are compared, so the clocks of bridge and beacon need not agree.
class BridgeBacklog {
public:
  explicit constexpr BridgeBacklog(TimeNs late_after_ns) : late_after_ns_(late_after_ns) {}

  /// `transit_ns`: time from the taking of the sample to its departure from the bridge, by their clocks;
  /// `now`: its arrival. Returns true if it took more than `late_after_ns` longer than the last sample before
  /// the stop. A lasting delay, as after a clock step or a pause of a recording, counts as usual after 0.1 s.
  bool on_sample(TimeNs transit_ns, SteadyTime now) {
    constexpr TimeNs slack_ns = 100'000'000;
    const TimeNs before_ns = std::exchange(latest_transit_ns_, transit_ns).value_or(transit_ns);
    const TimeNs step_ns = saturated_difference(transit_ns, before_ns);
    if (!is_behind_) usual_transit_ns_ = before_ns;
    if (step_ns > late_after_ns_) is_behind_ = true;
    if (step_ns > late_after_ns_ || step_ns < -late_after_ns_) {
      first_transit_ns_ = transit_ns;
      continued_ = now;
    }
    // A backlog leaves faster than it was taken.
    const bool drains = now - continued_ - slack_ns <= saturated_difference(first_transit_ns_, transit_ns);
    is_behind_ = is_behind_ && drains && saturated_difference(transit_ns, usual_transit_ns_) > late_after_ns_;
    return is_behind_;
  }

private:
  TimeNs late_after_ns_;
  std::optional<TimeNs> latest_transit_ns_;
  TimeNs usual_transit_ns_ = 0;  ///< transit before the stop
  TimeNs first_transit_ns_ = 0;  ///< transit right after the stop or a step
  SteadyTime continued_;
  bool is_behind_ = false;
};

}  // namespace sonopose::fusion
