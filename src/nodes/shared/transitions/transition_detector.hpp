#pragma once
/// \file
/// Detects changes of state in the poses and fix reports of one beacon.

#include "transitions/transition.hpp"
#include <sonopose/samples/pose.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

namespace sonopose::transitions {

/// Detects changes where poses are made: it compares bits, and neither allocates nor formats. Times are those
/// of the poses. Not thread-safe.
class TransitionDetector {
public:
  /// Consecutive outliers, about a second of fixes, after which the fixes are gated rather than noisy.
  static constexpr std::uint64_t gated_after = 10;
  /// Size above which a single correction is a relocation.
  static constexpr double relocated_m = 0.3;

  explicit TransitionDetector(BeaconAddress address) noexcept : address_(address) {}

  void on(const FusedPose& pose, TransitionQueue& pending) noexcept {
    if ((pose.status & status_predicted) != 0) return;
    if (!began_ns_) began_ns_ = pose.time_ns;
    follow_step(pose.time_ns);
    if (reset_counter_ && *reset_counter_ != pose.reset_counter) {
      pending.add({.address = address_, .kind = Kind::restarted});
      began_ns_ = pose.time_ns;
      is_initialised_ = false;
    }
    reset_counter_ = pose.reset_counter;
    if ((pose.status & status_initialising) != 0) return;  // implies the other bits
    if (!std::exchange(is_initialised_, true)) begin(pose, pending);
    for (std::size_t i = 0; i < bits.size(); ++i) compare(i, pose, pending);
    status_ = pose.status;
  }

  void on(const FixReport& report, TransitionQueue& pending) noexcept {
    if ((report.flags & (fix_stuck_forced | fix_stale_recovered)) != 0) {
      const double jump_m = report.jump_world_m.norm();
      if (jump_m > relocated_m) {
        pending.add({.address = address_, .kind = Kind::relocated, .value = jump_m});
      }
    }
    if ((report.flags & fix_outlier) != 0) {
      if (++outliers_ == 1) outliers_since_ns_ = report.emission_time_ns;
      if (outliers_ != gated_after) return;
      pending.add({.address = address_,
                   .kind = Kind::gated,
                   .value = report.innovation_world_m.norm(),
                   .count = outliers_});
    } else if ((report.flags & fix_used) != 0) {
      if (outliers_ >= gated_after) {
        pending.add({.address = address_,
                     .kind = Kind::gated,
                     .begins = false,
                     .lasted_s = seconds_between(outliers_since_ns_, report.emission_time_ns),
                     .count = outliers_});
      }
      outliers_ = 0;
    }
  }

private:
  struct Bit {
    PoseStatus bit;
    Kind kind;
    bool is_usual_at_start;  ///< usual start state: only its end is a change
  };
  static constexpr std::array<Bit, 8> bits{{{status_stale, Kind::stale, false},
                                            {status_frozen_track, Kind::frozen, false},
                                            {status_converging, Kind::converging, true},
                                            {status_low_trust, Kind::low_trust, true},
                                            {status_imu_inconsistent, Kind::imu_inconsistent, false},
                                            {status_fixes_inconsistent, Kind::fixes_inconsistent, false},
                                            {status_heading_unknown, Kind::heading_unknown, true},
                                            {status_imu_gap, Kind::imu_gap, false}}};

  /// Moves the starts of the states by a step of the clock, which is no duration.
  void follow_step(TimeNs time_ns) noexcept {
    constexpr TimeNs longest_silence_ns = 3'600'000'000'000;
    const TimeNs step_ns = saturated_difference(time_ns, last_ns_.value_or(time_ns));
    last_ns_ = time_ns;
    if (step_ns >= 0 && step_ns < longest_silence_ns) return;
    began_ns_ = saturated_sum(*began_ns_, step_ns);
    outliers_since_ns_ = saturated_sum(outliers_since_ns_, step_ns);
    for (TimeNs& since_ns : since_ns_) since_ns = saturated_sum(since_ns, step_ns);
  }

  void begin(const FusedPose& pose, TransitionQueue& pending) noexcept {
    pending.add({.address = address_,
                 .kind = Kind::initialised,
                 .lasted_s = seconds_between(*began_ns_, pose.time_ns)});
    since_ns_.fill(pose.time_ns);
    status_ = 0;
    for (const Bit& each : bits) {
      if (each.is_usual_at_start) status_ |= pose.status & each.bit;
    }
  }

  void compare(std::size_t i, const FusedPose& pose, TransitionQueue& pending) noexcept {
    const std::uint32_t bit = bits[i].bit;
    if (((status_ ^ pose.status) & bit) == 0) return;
    Transition transition{.address = address_, .kind = bits[i].kind, .begins = (pose.status & bit) != 0};
    if (transition.begins) {
      since_ns_[i] = pose.time_ns;
      transition.value = pose.since_valid_fix_s;
    } else {
      transition.lasted_s = seconds_between(since_ns_[i], pose.time_ns);
    }
    pending.add(transition);
  }

  BeaconAddress address_;
  bool is_initialised_ = false;
  std::uint32_t status_ = 0;  ///< status of the latest pose
  std::optional<std::uint32_t> reset_counter_;
  std::optional<TimeNs> began_ns_;              ///< time of the first pose, or of the first after a reset
  std::optional<TimeNs> last_ns_;               ///< time of the latest pose
  std::array<TimeNs, bits.size()> since_ns_{};  ///< start of each state
  std::uint64_t outliers_ = 0;                  ///< consecutive outliers
  TimeNs outliers_since_ns_ = 0;
};

}  // namespace sonopose::transitions
