#pragma once
/// \file
/// Which samples of a beacon a bridge sends after a pause of its own.

#include <sonopose/samples/time.hpp>

namespace sonopose::fusion {

/// A bridge that was stopped sends what has gathered at once: its samples are old when they leave it.
/// Compares the times of the samples with those at which they left, so the clocks of bridge and beacon need
/// not agree.
class BridgeBacklog {
public:
  explicit constexpr BridgeBacklog(TimeNs late_after_ns) : late_after_ns_(late_after_ns) {}

  /// `sensor_ns`, `bridge_ns`: when the sample was taken, and when it left the bridge. Returns whether it
  /// left more than `late_after_ns` later than the samples before the pause did. A delay that stays, as after
  /// a step of one clock, is usual after two seconds.
  bool on_sample(TimeNs sensor_ns, TimeNs bridge_ns) {
    constexpr TimeNs longest_ns = 2'000'000'000;
    const TimeNs transit_ns = saturated_difference(bridge_ns, sensor_ns);
    const TimeNs step_ns = has_latest_ ? saturated_difference(transit_ns, latest_transit_ns_) : 0;
    if (!is_behind_) usual_transit_ns_ = has_latest_ ? latest_transit_ns_ : transit_ns;
    if (step_ns > late_after_ns_) {
      is_behind_ = true;
      continued_ns_ = bridge_ns;
    }
    is_behind_ = is_behind_ && saturated_difference(transit_ns, usual_transit_ns_) > late_after_ns_ &&
                 saturated_difference(bridge_ns, continued_ns_) <= longest_ns;
    latest_transit_ns_ = transit_ns;
    has_latest_ = true;
    return is_behind_;
  }

private:
  TimeNs late_after_ns_;
  bool has_latest_ = false;
  bool is_behind_ = false;
  TimeNs latest_transit_ns_ = 0;
  TimeNs usual_transit_ns_ = 0;  ///< before the pause
  TimeNs continued_ns_ = 0;      ///< when the first sample after it left
};

}  // namespace sonopose::fusion
