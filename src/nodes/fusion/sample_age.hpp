#pragma once
/// \file
/// Decides which samples of a beacon are old.

#include "fusion/lateness.hpp"
#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace sonopose::fusion {

/// Age of a beacon's samples. Where stamps are times of this host's clock, as those of live beacons are, the
/// age is absolute: old samples stay old however long an overload lasts. Stamps of other clocks, such as
/// those of a recording, permit only a comparison with the samples before.
class SampleAge {
public:
  /// Times of a sample on its way.
  struct Times {
    std::uint64_t sequence = 0;  ///< event number
    TimeNs sensor_ns = 0;        ///< its stamp
    TimeNs bridge_ns = 0;        ///< departure from the bridge
    HostTime host_ns = 0;        ///< now
    SteadyTime now;
  };

  struct Judgement {
    bool is_old = false;
    TimeNs late_ns = 0;  ///< how much later than usual it arrives from the bridge
  };

  explicit constexpr SampleAge(TimeNs old_after_ns) : old_after_ns_(old_after_ns) {}

  Judgement on_sample(const Times& times) {
    const TimeNs late_ns =
        lateness_.on_sample(saturated_difference(times.now.ns, times.bridge_ns), times.now);
    const bool left_late = left_late_.on_sample(times, old_after_ns_);
    const TimeNs age_ns = saturated_difference(times.host_ns, times.sensor_ns);
    compare_clocks(times, age_ns);
    if (clocks_ == Clocks::differ) return {late_ns > old_after_ns_ || left_late, late_ns};
    if (clocks_ == Clocks::unknown) return {age_ns > old_after_ns_, late_ns};
    const TimeNs under_way_ns = saturated_difference(times.host_ns, times.bridge_ns);
    return {age_ns > old_after_ns_, std::max(late_ns, saturated_difference(under_way_ns, tolerance_ns))};
  }

private:
  /// Clock of the stamps, compared with this host's.
  enum class Clocks { unknown, agree, differ };

  /// Largest age that shows that the clocks agree, and smallest step of a clock.
  static constexpr TimeNs tolerance_ns = 50'000'000;

  /// What leaves a stopped bridge late, by stamps of any clock.
  class LateDeparture {
  public:
    /// Returns true if the sample left more than `late_after_ns` later than the last one before the stop. A
    /// lasting delay, as after a clock step or a pause of a recording, counts as usual after 1 s.
    bool on_sample(const Times& times, TimeNs late_after_ns) {
      constexpr TimeNs slack_ns = 1'000'000'000;  // pauses of a busy bridge in its backlog
      const TimeNs transit_ns = saturated_difference(times.bridge_ns, times.sensor_ns);
      const TimeNs before_ns = std::exchange(latest_transit_ns_, transit_ns).value_or(transit_ns);
      const TimeNs step_ns = saturated_difference(transit_ns, before_ns);
      if (!is_behind_) usual_transit_ns_ = before_ns;
      if (step_ns > late_after_ns) is_behind_ = true;
      if (step_ns > late_after_ns || step_ns < -late_after_ns) {
        first_transit_ns_ = transit_ns;
        continued_ = times.now;
      }
      // A backlog leaves faster than it was taken.
      const bool drains =
          times.now - continued_ - slack_ns <= saturated_difference(first_transit_ns_, transit_ns);
      is_behind_ =
          is_behind_ && drains && saturated_difference(transit_ns, usual_transit_ns_) > late_after_ns;
      return is_behind_;
    }

  private:
    std::optional<TimeNs> latest_transit_ns_;
    TimeNs usual_transit_ns_ = 0;  ///< before the stop
    TimeNs first_transit_ns_ = 0;  ///< right after the stop or a step
    SteadyTime continued_;
    bool is_behind_ = false;
  };

  void compare_clocks(const Times& times, TimeNs age_ns) {
    constexpr TimeNs max_backlog_ns = 86'400'000'000'000;  // stamps older than a day are of another clock
    constexpr TimeNs settled_after_ns = 2'000'000'000;
    constexpr TimeNs max_pause_ns = 100'000'000;
    const SteadyTime before = std::exchange(latest_, times.now);
    const TimeNs host_ahead_ns = saturated_difference(times.host_ns, times.now.ns);
    const TimeNs host_step_ns =
        saturated_difference(host_ahead_ns, std::exchange(host_ahead_ns_, host_ahead_ns));
    if (is_new_or_set_back(times)) {
      clocks_ = Clocks::unknown;
      least_age_ns_ = age_ns;
      settled_ns_ = 0;
    } else if (host_step_ns > tolerance_ns || host_step_ns < -tolerance_ns) {
      clocks_ = Clocks::differ;  // unless the next age shows that the bridge's clock was set too
    }
    if (age_ns < -tolerance_ns || age_ns > max_backlog_ns) {
      clocks_ = Clocks::differ;
    } else if (age_ns <= tolerance_ns) {
      clocks_ = Clocks::agree;
    } else if (clocks_ == Clocks::unknown) {
      settled_ns_ += std::min(times.now - before, max_pause_ns);  // a stop settles nothing
      if (age_ns < least_age_ns_ - tolerance_ns) {                // a backlog drains
        least_age_ns_ = age_ns;
        settled_ns_ = 0;
      }
      if (settled_ns_ > settled_after_ns) clocks_ = Clocks::differ;
    }
  }

  /// True at the first sample of a bridge, and if the bridge's clock was set back. A clock that was advanced
  /// shows in stamps of the future.
  bool is_new_or_set_back(const Times& times) {
    const bool is_first = times.sequence <= std::exchange(sequence_, times.sequence);
    const TimeNs advance_ns =
        saturated_difference(times.bridge_ns, std::exchange(bridge_ns_, times.bridge_ns));
    return is_first || advance_ns < -tolerance_ns;
  }

  TimeNs old_after_ns_;
  Lateness lateness_;
  LateDeparture left_late_;
  Clocks clocks_ = Clocks::unknown;
  SteadyTime latest_;  ///< arrival of the latest sample
  std::uint64_t sequence_ = std::numeric_limits<std::uint64_t>::max();
  TimeNs host_ahead_ns_ = 0;  ///< host's clock minus steady clock
  TimeNs bridge_ns_ = 0;      ///< departure of the latest sample
  TimeNs least_age_ns_ = 0;   ///< while unknown
  TimeNs settled_ns_ = 0;     ///< while unknown: time since the age fell
};

}  // namespace sonopose::fusion
