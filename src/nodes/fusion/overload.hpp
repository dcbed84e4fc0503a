#pragma once
/// \file
/// Adapts a fusion that cannot keep up with its input.

#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <atomic>

namespace sonopose::fusion {

/// Load of the fusion. Normally the receive thread fuses each event immediately. When samples arrive late,
/// it only receives, so that the socket does not overflow, and the backlog thread fuses the backlog. If that
/// thread falls behind too, the process is overloaded: poses of each beacon are written less often. Every
/// event is still fused.
///
/// Any thread may call `is_deferring` and `pose_spacing_ns`; call the others from one thread at a time.
class Overload {
public:
  /// Lateness of a pose above the usual at which events are deferred.
  static constexpr TimeNs late_after_ns = 20'000'000;
  /// Time without a late pose after which the receive thread fuses again.
  static constexpr TimeNs calm_after_ns = 1'000'000'000;
  /// Processor time of the backlog thread after which the spacing grows if poses are still late. Elapsed time
  /// would also count a single suspension, after which the thread catches up.
  static constexpr TimeNs behind_after_ns = 10'000'000;
  /// Time without an increase after which the spacing is halved.
  static constexpr TimeNs relax_after_ns = 500'000'000;
  static constexpr TimeNs first_spacing_ns = 40'000'000;
  static constexpr TimeNs max_spacing_ns =
      60'000'000;  ///< below the deadline, even with a sample every 40 ms
  static constexpr TimeNs min_spacing_ns = 10'000'000;

  /// Reports a pose written at `now`, `late_ns` later than usual after its sample.
  void on_pose(TimeNs late_ns, SteadyTime now) noexcept {
    if (late_ns <= late_after_ns) return;
    late_at_ = now;
    deferring_.store(true, std::memory_order_relaxed);
  }

  /// Reports that the backlog thread, which has used the processor for `worked_ns`, takes the backlog.
  void on_round(SteadyTime now, TimeNs worked_ns) noexcept {
    if (!busy_) worked_before_ns_ = worked_ns;
    busy_ = true;
    const TimeNs spacing_ns = pose_spacing_ns();
    const bool is_late = now - late_at_ <= late_after_ns;
    if (is_late && worked_ns - worked_before_ns_ > behind_after_ns) {
      worked_before_ns_ = worked_ns;
      changed_at_ = now;
      set_spacing(std::clamp(2 * spacing_ns, first_spacing_ns, max_spacing_ns));
    } else if (spacing_ns > 0 && now - changed_at_ > relax_after_ns) {
      changed_at_ = now;
      set_spacing(spacing_ns > min_spacing_ns ? spacing_ns / 2 : 0);
    }
  }

  /// Reports that the backlog thread has nothing left to take.
  void on_caught_up(SteadyTime now) noexcept {
    busy_ = false;
    if (pose_spacing_ns() > 0 || now - late_at_ <= calm_after_ns) return;
    deferring_.store(false, std::memory_order_relaxed);
  }

  /// True if the backlog thread takes events, instead of the receive thread.
  [[nodiscard]] bool is_deferring() const noexcept { return deferring_.load(std::memory_order_relaxed); }
  /// Shortest time between two poses of a beacon; 0 unless overloaded.
  [[nodiscard]] TimeNs pose_spacing_ns() const noexcept {
    return spacing_ns_.load(std::memory_order_relaxed);
  }

  [[nodiscard]] bool is_overloaded() const noexcept { return pose_spacing_ns() > 0; }

private:
  void set_spacing(TimeNs spacing_ns) { spacing_ns_.store(spacing_ns, std::memory_order_relaxed); }

  std::atomic<bool> deferring_ = false;
  std::atomic<TimeNs> spacing_ns_ = 0;
  bool busy_ = false;  ///< not caught up since `worked_before_ns_`
  TimeNs worked_before_ns_ = 0;
  SteadyTime late_at_;     ///< time of the latest late pose
  SteadyTime changed_at_;  ///< time of the latest change of the spacing
};

}  // namespace sonopose::fusion
