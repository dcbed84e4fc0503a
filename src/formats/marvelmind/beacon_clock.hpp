#pragma once
/// \file
/// Converts beacon time to host time. All later stages use only nanoseconds of the host's clock.

#include "marvelmind/lower_envelope.hpp"
#include "marvelmind/packet.hpp"
#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sonopose::marvelmind {

/// Limit between a restarted clock, which goes back further, and an overtaken packet.
inline constexpr std::int64_t overtaken_ns = 250'000'000;

/// Returns true if the stamp can be converted to nanoseconds. Only a unix time can be out of range.
constexpr bool is_plausible(const Stamp& stamp) {
  constexpr std::int64_t year_2100_ms = 4'102'444'800'000;
  return stamp.ticks >= 0 && stamp.ticks < year_2100_ms;
}

/// Unwraps the stamps of one time base: a u32 becomes the value nearest to the newest stamp.
class Unwrapper {
public:
  /// Converts a stamp to nanoseconds since the zero of the beacon's clock.
  std::int64_t beacon_ns(const Stamp& stamp) const;

  void set_newest(const Stamp& stamp) { newest_ticks_ = unwrapped(stamp); }

  void restart() { newest_ticks_.reset(); }

private:
  std::int64_t unwrapped(const Stamp& stamp) const;

  std::optional<std::int64_t> newest_ticks_;
};

/// A piecewise linear function from beacon time to host time that is extended during use. Its times rise, its
/// slope differs from the wanted rate by at most `max_slew`, and its past never changes.
class SlewedLine {
public:
  static constexpr double max_slew = 4e-3;
  static constexpr double time_constant_ns = 5e9;

  /// Restarts with one point.
  void begin(std::int64_t beacon_ns, TimeNs host_ns);

  /// Extends to `beacon_ns` at `rate`, towards `target_ns` as far as the slew allows.
  void advance(std::int64_t beacon_ns, TimeNs target_ns, double rate);

  TimeNs host_ns(std::int64_t beacon_ns) const;

  std::int64_t newest_offset_ns() const { return point(size_ - 1).host_ns - point(size_ - 1).beacon_ns; }

private:
  struct Point {
    std::int64_t beacon_ns = 0;
    TimeNs host_ns = 0;
  };
  static constexpr std::size_t capacity = 128;

  const Point& point(std::size_t i) const { return points_[(first_ + i) % capacity]; }

  std::array<Point, capacity> points_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  double rate_ = 0;
};

/// Maps the stamps of one beacon and time base by their arrivals.
///
/// The target is the lower envelope of the arrivals (`LowerEnvelope`), since no arrival is early. The mapping
/// slews towards it with a time constant of 5 s and by at most 0.4 %, so that intervals between mapped stamps
/// can be integrated. It never steps and never goes back.
///
/// It restarts if the beacon's clock goes back, or if mapped stamps are behind by more than 1 s. It also
/// restarts if they are so far ahead that a fix, which takes about 70 ms, would arrive before its emission: a
/// slow line has become fast again. It settles after a quarter of a second, so that one late first packet
/// need not be slewed away, and in which the delay does not fall, as while a backlog drains. A later first
/// packet than a port stores is one of before the clock was set.
class BeaconClock {
public:
  static constexpr std::int64_t settling_ns = 250'000'000;
  static constexpr std::int64_t max_behind_ns = 1'000'000'000;
  static constexpr std::int64_t max_ahead_ns = 65'000'000;
  static constexpr std::int64_t max_stored_ns = 10'000'000'000;
  /// Fall of the delay, beyond jitter, with which a backlog drains.
  static constexpr std::int64_t draining_ns = 20'000'000;

  /// Takes the arrival of a packet that was sent `send_delay_ns` after `stamp`.
  void observe(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns);

  /// Settles if it is due at `now_ns`.
  void advance_to(TimeNs now_ns);

  /// Settles immediately, on the observations so far. Needs at least one.
  void settle();

  /// True if stamps can be mapped.
  bool settled() const { return settled_; }

  /// Time at which the clock will settle; empty if it has settled or not begun.
  std::optional<TimeNs> settles_at_ns() const;

  /// The host's time at `stamp`, which may be seconds before the newest one. Needs `settled()`.
  TimeNs host_ns(const Stamp& stamp) const { return line_.host_ns(unwrapper_.beacon_ns(stamp)); }

  /// Mapped difference host − beacon.
  double offset_s() const;

  /// Mean delay of the arrivals above the envelope, over about the last hundred.
  double jitter_s() const { return jitter_s_; }

  /// Number of detected restarts of the beacon's clock.
  std::uint64_t resets() const { return resets_; }

  /// Number of steps of the beacon's clock, counted when it has settled after them, and the size of the
  /// newest one.
  std::uint64_t steps() const { return steps_; }
  std::int64_t newest_step_ns() const { return newest_step_ns_; }

private:
  void begin(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns);
  void restart(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns);
  void measure_jitter(std::int64_t beacon_ns, TimeNs arrival_ns);

  Unwrapper unwrapper_;
  LowerEnvelope envelope_;
  SlewedLine line_;
  std::int64_t newest_ns_ = 0;
  TimeNs settles_from_ns_ = 0;          ///< first arrival, or the latest at which the delay fell
  std::int64_t settling_delay_ns_ = 0;  ///< delay at that arrival
  bool begun_ = false;
  bool settled_ = false;
  double jitter_s_ = 0;
  std::uint64_t resets_ = 0;
  std::optional<std::int64_t> delay_before_ns_;  ///< delay before a restart, until the clock has settled
  std::uint64_t steps_ = 0;
  std::int64_t newest_step_ns_ = 0;
};

/// Maps by the beacon's clock alone, for bytes from a file. The first packet was sent at its arrival, and
/// every stamp keeps its distance to that. The same bytes always give the same times. After a restart of the
/// beacon, or if its clock was set, time continues from the newest one. A step ahead by less than a day may
/// be a pause of the recording: it is one, unless a position with the time before the step is sent after it.
/// The clock waits for that until the first position, for at most `settling_ns`. Same interface as
/// `BeaconClock`.
class FixedClock {
public:
  /// Shortest step ahead that cannot be a pause of the recording.
  static constexpr std::int64_t set_ahead_ns = 86'400'000'000'000;

  /// Longest wait for a position after a step ahead.
  static constexpr std::int64_t settling_ns = 250'000'000;

  /// Takes a packet that was sent `send_delay_ns` after `stamp`. Only the first `arrival_ns` matters.
  void observe(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns);

  void advance_to(TimeNs /*now_ns*/) {}
  void settle() { settled_ = true; }
  /// False while a step ahead may be a pause or a clock that was set.
  bool settled() const { return settled_; }
  std::optional<TimeNs> settles_at_ns() const { return std::nullopt; }

  /// The host's time at `stamp`. Needs an observation.
  TimeNs host_ns(const Stamp& stamp) const;

  double offset_s() const { return static_cast<double>(line_.origin_ns - line_.first_ns) * 1e-9; }
  double jitter_s() const { return 0; }

  /// Number of steps back and of those ahead by `set_ahead_ns` or more; `steps` also counts shorter ones
  /// ahead.
  std::uint64_t resets() const { return resets_; }

  /// Number of steps of the beacon's clock, and the size of the newest one.
  std::uint64_t steps() const { return steps_; }
  std::int64_t newest_step_ns() const { return newest_step_ns_; }

private:
  struct Line {
    TimeNs origin_ns = 0;
    std::int64_t first_ns = 0;

    TimeNs host_ns(std::int64_t beacon_ns) const {
      return std::min(saturated_sum(origin_ns, beacon_ns - first_ns), end_of_time_ns - 1);
    }
  };

  /// The latest step of the stamps.
  struct Step {
    Line line_before;
    std::int64_t newest_before_ns = 0;
    std::int64_t first_ns = 0;                 ///< first stamp after it
    std::optional<std::int64_t> under_way_ns;  ///< latest stamp of before it that arrived after it

    std::int64_t size_ns() const { return first_ns - newest_before_ns; }
  };

  void count_step(std::int64_t step_ns);
  void take_step(const Stamp& stamp, std::int64_t send_delay_ns);
  bool take_under_way(const Stamp& stamp, std::int64_t send_delay_ns);
  void begin(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs host_ns);

  Unwrapper unwrapper_;
  Line line_;
  std::int64_t newest_ns_ = 0;
  std::optional<Step> step_;
  bool begun_ = false;
  bool settled_ = true;
  std::uint64_t resets_ = 0;
  std::uint64_t steps_ = 0;
  std::int64_t newest_step_ns_ = 0;
};

}  // namespace sonopose::marvelmind
