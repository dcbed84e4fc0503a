#pragma once
/// \file
/// Events of about the last 1.2 s in the order of their measurement, with earlier states to return to.

#include <sonopose/estimation/kalman/checkpoints.hpp>

#include <limits>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace sonopose::estimation::kalman {

inline constexpr std::size_t imu_capacity = 2048;
inline constexpr std::size_t aiding_capacity = 512;                 ///< fixes, headings and velocities
inline constexpr std::size_t twist_capacity = aiding_capacity / 2;  ///< places that velocities may fill

/// A fix, a heading or a velocity of the body.
using AidingMeasurement = std::variant<FixMeasurement, HeadingMeasurement, TwistMeasurement>;

/// True if both are the same measurement, which may have arrived at different times.
inline bool is_copy(const AidingMeasurement& a, const AidingMeasurement& b) {
  if (a == b) return true;
  const auto equal = [&b](const auto& measured, const auto& value_of) {
    const auto* other = std::get_if<std::remove_cvref_t<decltype(measured)>>(&b);
    return other != nullptr && measured.stamp_ns != 0 && measured.stamp_ns == other->stamp_ns &&
           value_of(measured) == value_of(*other);
  };
  if (const auto* fix = std::get_if<FixMeasurement>(&a)) {
    return equal(*fix, [](const FixMeasurement& any) { return any.position_world_m; });
  }
  if (const auto* twist = std::get_if<TwistMeasurement>(&a)) {
    return equal(*twist, [](const TwistMeasurement& any) {
      return std::pair(any.velocity_body_mps, any.std_mps);  // which axes were measured, too
    });
  }
  return equal(std::get<HeadingMeasurement>(a),
               [](const HeadingMeasurement& any) { return any.heading_world_rad; });
}

/// Sort key in time. A heading follows the fix of the same emission, even if their stamps differ a little.
inline TimeNs order_key(const AidingMeasurement& aiding) {
  constexpr TimeNs after_fix_ns = 500'000;
  const TimeNs time_ns = std::visit([](const auto& any) { return any.time_ns; }, aiding);
  return std::holds_alternative<HeadingMeasurement>(aiding) ? time_ns + after_fix_ns : time_ns;
}

/// Oldest state that is kept and the events since then: enough to compute everything again.
struct History {
  State base;
  std::vector<ImuMeasurement> imu;
  std::vector<FixMeasurement> fixes;
  std::vector<HeadingMeasurement> headings;
  std::vector<TwistMeasurement> twists;
  bool stamps_are_ahead = false;  ///< true if the last fix or heading was removed as one from the future

  bool operator==(const History&) const = default;
};

/// Processes events in the order of their measurement. Its memory is allocated at construction.
class DelayedFusionBuffer {
public:
  DelayedFusionBuffer();

  /// Removes all events and states.
  void clear();

  /// Begins with known errors of the sensors. Has no effect after the first sample.
  void start_from(const aiding::KnownSensors& known);

  /// Current state. After `add` of a fix or heading it includes this event; after `add` of a sample it
  /// excludes it; after `finish_pending_work` it includes all events.
  [[nodiscard]] const State& now() const { return now_; }

  /// True if `finish_pending_work` has work left.
  [[nodiscard]] bool has_pending_work() const { return has_pending_work_; }
  /// True if that work is the sample that was added last.
  [[nodiscard]] bool has_pending_sample() const { return has_pending_work_ && until_ns_ != forever_ns; }

  /// Time of the latest sample; 0 before the first.
  [[nodiscard]] TimeNs time_ns() const { return time_ns_; }

  /// Adds a sample that is not older than the latest one and advances the state to just before it. Call
  /// `finish_pending_work` before, and afterwards to process the sample. Returns true if it follows all other
  /// events and the state is still that of the last `finish_pending_work`.
  bool add(const settings::Settings& settings, const ImuMeasurement& imu);

  /// Numbers of measurements that the last sample has removed: their stamps were ahead of it.
  struct Dropped {
    std::uint64_t headings = 0;
    std::uint64_t twists = 0;
  };
  [[nodiscard]] Dropped dropped() const { return dropped_; }

  /// Time by which a measurement may be ahead of the latest sample. It may be seconds while the IMU is
  /// silent, unless samples have shown that the stamps of fixes and headings are wrong.
  [[nodiscard]] double max_ahead_s() const;

  /// True if a measurement of this time can still be inserted: it is not too old, and there is room.
  [[nodiscard]] bool can_insert(TimeNs time_ns) const;

  /// True if there is room for a velocity too.
  [[nodiscard]] bool has_place_for_twist() const { return aiding_.size() < twist_capacity; }

  /// True if the same measurement is already stored.
  [[nodiscard]] bool contains(const AidingMeasurement& aiding) const;

  /// Inserts a measurement at its time; `finish_pending_work` repeats the later events. Returns the outcome
  /// of a fix. After a sample, call `finish_pending_work` first: it decides which measurements are too old.
  FixOutcome add(const settings::Settings& settings, const AidingMeasurement& aiding);

  /// Handles a change of the mount offset by this angle. Earlier measurements are no longer inserted, because
  /// their headings have another offset. Requires `finish_pending_work` before.
  void on_mount_offset_change(double by_rad);

  /// Advances to the latest sample, or repeats the events after the last measurement.
  void finish_pending_work(const settings::Settings& settings);

  [[nodiscard]] History history() const;
  void restore(const settings::Settings& settings, const History& history);

private:
  static constexpr TimeNs forever_ns = std::numeric_limits<TimeNs>::max();
  [[nodiscard]] ImuMeasurement& imu_at(std::uint64_t number) { return imu_[number % imu_.size()]; }
  void make_place_for_imu();
  std::size_t insert(const AidingMeasurement& aiding);
  void rewind(TimeNs time_ns);
  void replay_imu(const settings::Settings& settings, const ImuMeasurement& imu);
  void drop_future(TimeNs now_ns);
  FixOutcome replay(const settings::Settings& settings, const AidingMeasurement* last,
                    TimeNs until_ns = forever_ns);
  void save_checkpoint();
  void restart();
  void drop_oldest_checkpoint();
  void forget_before_oldest();

  State now_;
  TimeNs time_ns_ = 0;
  std::uint64_t next_imu_ = 0;       // next sample to replay into now_
  std::size_t next_aiding_ = 0;      // index into aiding_
  std::vector<ImuMeasurement> imu_;  // ring buffer, as large as needed so far
  std::uint64_t first_imu_ = 0;
  std::uint64_t end_imu_ = 0;
  std::vector<AidingMeasurement> aiding_;  // sorted by time
  Checkpoints checkpoints_;
  bool stamps_are_ahead_ = false;
  Dropped dropped_;
  bool has_pending_work_ = false;
  TimeNs until_ns_ = 0;  // time up to which finish_pending_work replays fixes and headings
};

}  // namespace sonopose::estimation::kalman
