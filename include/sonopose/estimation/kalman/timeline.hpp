#pragma once
/// \file
/// The events of about the last 1.2 s in the order of their measurement, and earlier states to go back to.

#include <sonopose/estimation/kalman/checkpoints.hpp>

#include <limits>
#include <variant>
#include <vector>

namespace sonopose::estimation::kalman {

inline constexpr std::size_t imu_capacity = 2048;
inline constexpr std::size_t aiding_capacity = 512;  ///< fixes and headings

/// A fix or a heading.
using Aiding = std::variant<FixMeasurement, HeadingMeasurement>;

/// True if both are the same measurement, which may have arrived at different times.
inline bool is_copy(const Aiding& a, const Aiding& b) {
  if (a == b) return true;
  if (const auto* fix = std::get_if<FixMeasurement>(&a)) {
    const auto* other = std::get_if<FixMeasurement>(&b);
    return other != nullptr && fix->stamp_ns != 0 && fix->stamp_ns == other->stamp_ns &&
           fix->position_world_m == other->position_world_m;
  }
  const auto& heading = std::get<HeadingMeasurement>(a);
  const auto* other = std::get_if<HeadingMeasurement>(&b);
  return other != nullptr && heading.stamp_ns != 0 && heading.stamp_ns == other->stamp_ns &&
         heading.heading_world_rad == other->heading_world_rad;
}

/// Time of its turn. A heading follows the fix of the same emission, even if their stamps differ a little.
inline TimeNs turn_of(const Aiding& aiding) {
  constexpr TimeNs after_fix_ns = 500'000;
  const auto* fix = std::get_if<FixMeasurement>(&aiding);
  return fix != nullptr ? fix->time_ns : std::get<HeadingMeasurement>(aiding).time_ns + after_fix_ns;
}

/// The oldest state that is kept, and the events since then: enough to compute everything again.
struct History {
  State base;
  std::vector<ImuMeasurement> imu;
  std::vector<FixMeasurement> fixes;
  std::vector<HeadingMeasurement> headings;
  bool stamps_are_ahead = false;  ///< the last fix or heading was removed as one from the future

  bool operator==(const History&) const = default;
};

/// Its memory is allocated at construction.
class Timeline {
public:
  Timeline();

  /// Forgets everything.
  void clear();

  /// After `add` of a fix or heading: the state just after it. After `add` of a sample: just before it.
  /// After `catch_up`: after all events.
  [[nodiscard]] const State& now() const { return now_; }

  /// True if `catch_up` has something left to do.
  [[nodiscard]] bool is_behind() const { return is_behind_; }
  /// True if it is a sample that was added last.
  [[nodiscard]] bool is_behind_sample() const { return is_behind_ && until_ns_ != forever_ns; }

  /// The time of the latest sample; 0 before the first.
  [[nodiscard]] TimeNs time_ns() const { return time_ns_; }

  /// Adds a sample that is not older than the latest one, and goes on to just before it; `catch_up` goes on
  /// to it. Returns whether it comes after everything else, and the state is still that of the last
  /// `catch_up`. Requires `catch_up` before.
  bool add(const settings::Settings& settings, const ImuMeasurement& imu);

  /// Time by which a measurement may be ahead of the latest sample. A silent IMU explains seconds, unless
  /// samples showed that the stamps of fixes and headings are wrong.
  [[nodiscard]] double ahead_s() const;

  /// True if a measurement of this time can still be inserted: it is not too old, and there are not too many.
  [[nodiscard]] bool reaches(TimeNs time_ns) const;

  /// True if the same measurement is there already.
  [[nodiscard]] bool contains(const Aiding& aiding) const;

  /// Inserts a measurement where it belongs. What followed is repeated by `catch_up`. Returns the outcome of
  /// a fix. After a sample call `catch_up` first: it decides which measurements are too old.
  FixOutcome add(const settings::Settings& settings, const Aiding& aiding);

  /// The mount offset was changed by this angle. What was measured before is no longer inserted: the headings
  /// of then are those of another offset. Requires `catch_up` before.
  void on_mount_offset_change(double by_rad);

  /// Goes on to the latest sample, or repeats what followed the last measurement.
  void catch_up(const settings::Settings& settings);

  [[nodiscard]] History history() const;
  void restore(const settings::Settings& settings, const History& history);

private:
  static constexpr TimeNs forever_ns = std::numeric_limits<TimeNs>::max();
  [[nodiscard]] ImuMeasurement& imu_at(std::uint64_t number) { return imu_[number % imu_.size()]; }
  void make_place_for_imu();
  std::size_t insert(const Aiding& aiding);
  void rewind(TimeNs time_ns);
  void fold_imu(const settings::Settings& settings, const ImuMeasurement& imu);
  void drop_future(TimeNs now_ns);
  FixOutcome fold(const settings::Settings& settings, const Aiding* last, TimeNs until_ns = forever_ns);
  void save_checkpoint();
  void begin_again();
  void drop_oldest_checkpoint();
  void forget_before_oldest();

  State now_;
  TimeNs time_ns_ = 0;
  std::uint64_t next_imu_ = 0;       // that is folded into now_
  std::size_t next_aiding_ = 0;      // index into aiding_
  std::vector<ImuMeasurement> imu_;  // ring; as large as it was needed
  std::uint64_t first_imu_ = 0;
  std::uint64_t end_imu_ = 0;
  std::vector<Aiding> aiding_;  // sorted by time
  Checkpoints checkpoints_;
  bool stamps_are_ahead_ = false;
  bool is_behind_ = false;
  TimeNs until_ns_ = 0;  // up to which catch_up folds fixes and headings
};

}  // namespace sonopose::estimation::kalman
