#pragma once
/// \file
/// Decides which samples of a beacon are old.

#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace sonopose::fusion {

/// Age of a beacon's samples: the time until they leave the bridge plus the time from the bridge to here.
///
/// The first part is absolute where stamps are times of the bridge's host, as for live beacons. The second is
/// measured against the smallest value so far, whose drift is followed, because the bridge's host may have
/// another clock. Until a small value was seen, the time by the clocks of the two hosts is used if plausible:
/// a fusion may be busy from its start. So old samples stay old however long a bridge or this process is
/// overloaded. Only a delay that stays constant, or whose minimum per second does, counts as a clock offset.
class SampleAge {
public:
  /// Times of a sample on its way.
  struct Times {
    std::uint64_t sequence = 0;  ///< event number
    TimeNs sensor_ns = 0;        ///< its stamp
    TimeNs bridge_ns = 0;        ///< departure, by the clock of the bridge's host
    TimeNs host_ns = 0;          ///< now, by the clock of this host
    SteadyTime now;
  };

  struct Judgement {
    bool is_old = false;
    TimeNs late_ns = 0;  ///< excess over the usual time from the bridge
  };

  explicit constexpr SampleAge(TimeNs old_after_ns) : old_after_ns_(old_after_ns) {}

  Judgement on_sample(const Times& times) {
    const bool is_first = times.sequence <= std::exchange(sequence_, times.sequence);
    const TimeNs advance_ns =
        saturated_difference(times.bridge_ns, std::exchange(bridge_ns_, times.bridge_ns));
    if (is_first) departure_ = {};
    if (is_first || advance_ns < -tolerance_ns) transport_ = {};  // the bridge's clock was set back
    const Transport::Excess late =
        transport_.excess(saturated_difference(times.now.ns, times.bridge_ns),
                          saturated_difference(times.host_ns, times.bridge_ns), times.now);
    const TimeNs left_late_ns =
        departure_.excess(saturated_difference(times.bridge_ns, times.sensor_ns), times.now);
    return {saturated_sum(left_late_ns, late.by_clocks_ns) > old_after_ns_, late.over_usual_ns};
  }

private:
  static constexpr TimeNs tolerance_ns = 50'000'000;

  /// Detects a delay that stays the same.
  class Constancy {
  public:
    /// Returns the time since the delay last changed by more than half of the tolerance.
    TimeNs lasted_ns(TimeNs delay_ns, SteadyTime now) {
      const TimeNs change_ns = saturated_difference(delay_ns, first_ns_);
      if (change_ns > tolerance_ns / 2 || change_ns < -tolerance_ns / 2) {
        first_ns_ = delay_ns;
        began_ = now;
      }
      return now - began_;
    }

  private:
    TimeNs first_ns_ = std::numeric_limits<TimeNs>::max();
    SteadyTime began_;
  };

  /// Detects that the least delay of each second stays the same for three seconds, with most others near it:
  /// a network delays a few samples, a busy process most of them.
  class ConstantMinimum {
  public:
    bool add(TimeNs delay_ns, SteadyTime now) {
      constexpr TimeNs second_ns = 1'000'000'000;
      if (!began_ || now - *began_ >= second_ns) {
        const TimeNs change_ns = saturated_difference(min_ns_, before_ns_);
        const bool is_equal = change_ns <= tolerance_ns / 2 && change_ns >= -tolerance_ns / 2;
        const bool are_near = 4 * near_ >= 3 * count_;
        equal_seconds_ = began_ && is_equal && are_near ? equal_seconds_ + 1 : 0;
        before_ns_ = std::exchange(min_ns_, delay_ns);
        count_ = near_ = 0;
        began_ = now;
      }
      min_ns_ = std::min(min_ns_, delay_ns);
      ++count_;
      if (saturated_difference(delay_ns, before_ns_) <= tolerance_ns / 2) ++near_;
      return equal_seconds_ >= 2;
    }

  private:
    TimeNs min_ns_ = std::numeric_limits<TimeNs>::max();     ///< least age in the present second
    TimeNs before_ns_ = std::numeric_limits<TimeNs>::min();  ///< least age in the second before
    int count_ = 0;                                          ///< delays of the present second
    int near_ = 0;  ///< those near the least one of the second before
    int equal_seconds_ = 0;
    std::optional<SteadyTime> began_;
  };

  /// Time from the bridge to here, by clocks that differ by a constant and drift apart.
  class Transport {
  public:
    struct Excess {
      TimeNs over_usual_ns = 0;  ///< over the least time, which is raised slowly while the excess is small
      TimeNs by_clocks_ns = 0;   ///< the same, or the time by the clocks of the hosts until one was small
    };

    /// `by_clocks_ns`: the time by the clocks of the two hosts.
    Excess excess(TimeNs time_ns, TimeNs by_clocks_ns, SteadyTime now) {
      constexpr TimeNs constant_after_ns = 10'000'000'000;
      constexpr TimeNs max_drift_ns = 20'000'000;
      constexpr TimeNs per_drift = 1000;  // 1 ms in a second
      constexpr TimeNs max_backlog_ns = 10'000'000'000;
      const TimeNs elapsed_ns = now - std::exchange(latest_, now);
      if (time_ns < usual_ns_ || constancy_.lasted_ns(time_ns, now) > constant_after_ns) usual_ns_ = time_ns;
      const TimeNs excess_ns = saturated_difference(time_ns, usual_ns_);
      if (excess_ns < max_drift_ns) usual_ns_ += std::min(excess_ns, elapsed_ns / per_drift);
      are_clocks_asked_ = are_clocks_asked_ && by_clocks_ns > max_drift_ns && by_clocks_ns < max_backlog_ns &&
                          !minimum_.add(time_ns, now);
      return {excess_ns, are_clocks_asked_ ? std::max(excess_ns, by_clocks_ns) : excess_ns};
    }

  private:
    TimeNs usual_ns_ = std::numeric_limits<TimeNs>::max();
    bool are_clocks_asked_ = true;  ///< until they show a small time or disagree
    SteadyTime latest_;
    Constancy constancy_;
    ConstantMinimum minimum_;
  };

  /// Time from the stamp to the departure from the bridge.
  class Departure {
  public:
    /// Returns the age at departure. Stamps of the future, or older than a day, are of another clock. So are
    /// others whose age stays the same, or never was small for some time: then it is the excess over the
    /// least one.
    TimeNs excess(TimeNs age_ns, SteadyTime now) {
      constexpr TimeNs max_backlog_ns = 86'400'000'000'000;
      constexpr TimeNs unknown_for_ns = 10'000'000'000;
      constexpr TimeNs constant_after_ns = 3'000'000'000;
      constexpr TimeNs constant_after_small_ns = 60'000'000'000;
      if (!began_) began_ = now;
      const TimeNs constant_ns = constancy_.lasted_ns(age_ns, now);
      const bool is_constant =
          constant_ns > (stamps_ == Stamps::of_the_host ? constant_after_small_ns : constant_after_ns);
      const bool is_never_small = stamps_ == Stamps::unknown && now - *began_ > unknown_for_ns;
      if (age_ns >= -tolerance_ns && age_ns <= tolerance_ns) {
        stamps_ = Stamps::of_the_host;
        min_ns_ = 0;
      } else if (age_ns < 0 || age_ns > max_backlog_ns || is_constant || is_never_small) {
        stamps_ = Stamps::of_another_clock;
        min_ns_ = age_ns;
      } else if (stamps_ == Stamps::of_another_clock) {
        min_ns_ = std::min(min_ns_, age_ns);
      }
      return std::max<TimeNs>(saturated_difference(age_ns, min_ns_), 0);
    }

  private:
    enum class Stamps { unknown, of_the_host, of_another_clock };

    Stamps stamps_ = Stamps::unknown;
    TimeNs min_ns_ = 0;  ///< 0 unless of another clock
    std::optional<SteadyTime> began_;
    Constancy constancy_;
  };

  TimeNs old_after_ns_;
  std::uint64_t sequence_ = std::numeric_limits<std::uint64_t>::max();
  TimeNs bridge_ns_ = 0;  ///< departure of the latest sample
  Departure departure_;
  Transport transport_;
};

}  // namespace sonopose::fusion
