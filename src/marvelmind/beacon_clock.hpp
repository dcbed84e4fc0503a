#pragma once
/// \file
/// Beacon time → host time, once: everything behind it is ns in the host's clock.

#include <sonopose/samples/samples.hpp>
#include "marvelmind/lower_envelope.hpp"
#include "marvelmind/packet.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sonopose::marvelmind {

/// A clock that goes back by more than this has restarted; less is a packet that was overtaken.
inline constexpr std::int64_t overtaken_ns = 250'000'000;

/// Can the stamp be turned into ns? Only a unix time can be out of range.
constexpr bool is_plausible(const Stamp& stamp) {
  constexpr std::int64_t year_2200_ms = 7'258'118'400'000;
  return stamp.ticks >= 0 && stamp.ticks < year_2200_ms;
}

/// Stamps of one time base as ns that do not wrap: a u32 is taken as the value nearest to the newest one.
class Unwrapper {
public:
  /// ns since the zero of the beacon's clock.
  std::int64_t beacon_ns(const Stamp& stamp) const;

  /// The newest stamp, which later ones are near to.
  void follow(const Stamp& stamp) { newest_ticks_ = unwrapped(stamp); }

  void restart() { newest_ticks_.reset(); }

private:
  std::int64_t unwrapped(const Stamp& stamp) const;

  std::optional<std::int64_t> newest_ticks_;
};

/// A function beacon time → host time that is made while it is used: it runs through points with rising
/// times, its slope is never further from the wanted rate than `max_slew`, and its past does not change any
/// more.
class SlewedLine {
public:
  static constexpr double max_slew = 4e-3;
  static constexpr double time_constant_ns = 5e9;

  /// Starts anew, through one point.
  void begin(std::int64_t beacon_ns, TimeNs host_ns);

  /// Goes on to `beacon_ns` at `rate`, and toward `target_ns` as far as the slew allows.
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
/// Target is the lower envelope of the arrivals (`LowerEnvelope`): an arrival is never early. The mapping
/// follows it by slewing, with a time constant of 5 s and by no more than 0.4 %, so that intervals between
/// mapped stamps may be integrated over; it never steps and never goes back. A clock that goes back, or is
/// away from the host's by more than 1 s, belongs to a beacon that has restarted: the mapping then starts
/// anew. For its first quarter of a second it only listens, so that one late first packet does not have to be
/// slewed away.
class BeaconClock {
public:
  static constexpr std::int64_t settling_ns = 250'000'000;
  static constexpr std::int64_t restart_ns = 1'000'000'000;

  /// Takes the arrival of a packet that the beacon sent `ahead_ns` after the moment of `stamp`.
  void observe(const Stamp& stamp, std::int64_t ahead_ns, TimeNs arrival_ns);

  /// Lets time pass: settles when it is due.
  void advance_to(TimeNs now_ns);

  /// Settles at once, with what was seen until now. Needs an observation.
  void settle();

  /// Can stamps be mapped?
  bool settled() const { return settled_; }

  /// When it will be settled; nothing where it is, or has not begun.
  std::optional<TimeNs> settles_at_ns() const;

  /// The host's time at `stamp`, which may lie up to seconds before the newest one. Needs `settled()`.
  TimeNs host_ns(const Stamp& stamp) const { return line_.host_ns(unwrapper_.beacon_ns(stamp)); }

  /// Host − beacon, as mapped.
  double offset_s() const;

  /// Mean lateness of the arrivals above the envelope, over the last hundred or so.
  double jitter_s() const { return jitter_s_; }

  /// How often the beacon's clock was found to have restarted.
  std::uint64_t resets() const { return resets_; }

private:
  void begin(const Stamp& stamp, std::int64_t ahead_ns, TimeNs arrival_ns);
  void restart(const Stamp& stamp, std::int64_t ahead_ns, TimeNs arrival_ns);
  void measure_jitter(std::int64_t beacon_ns, TimeNs arrival_ns);

  Unwrapper unwrapper_;
  LowerEnvelope envelope_;
  SlewedLine line_;
  std::int64_t newest_ns_ = 0;
  TimeNs first_arrival_ns_ = 0;
  bool begun_ = false;
  bool settled_ = false;
  double jitter_s_ = 0;
  std::uint64_t resets_ = 0;
};

/// Maps by the beacon's clock alone, for bytes that are read from a file: the first packet was sent when it
/// arrived, and every stamp is as far from that as the beacon counts. Same bytes, same times. A restart of
/// the beacon goes on from the newest time reached. Has the interface of `BeaconClock`.
class FixedClock {
public:
  /// Takes a packet that the beacon sent `ahead_ns` after the moment of `stamp`; `arrival_ns` counts for the
  /// first one alone.
  void observe(const Stamp& stamp, std::int64_t ahead_ns, TimeNs arrival_ns);

  void advance_to(TimeNs /*now_ns*/) {}
  void settle() {}
  bool settled() const { return true; }
  std::optional<TimeNs> settles_at_ns() const { return std::nullopt; }

  /// The host's time at `stamp`. Needs an observation before.
  TimeNs host_ns(const Stamp& stamp) const { return origin_ns_ + unwrapper_.beacon_ns(stamp) - first_ns_; }

  double offset_s() const { return static_cast<double>(origin_ns_ - first_ns_) * 1e-9; }
  double jitter_s() const { return 0; }
  std::uint64_t resets() const { return resets_; }

private:
  void begin(const Stamp& stamp, std::int64_t ahead_ns, TimeNs host_ns);

  Unwrapper unwrapper_;
  TimeNs origin_ns_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t newest_ns_ = 0;
  bool begun_ = false;
  std::uint64_t resets_ = 0;
};

}  // namespace sonopose::marvelmind
