#pragma once
/// \file
/// The clocks of one beacon: one a time base, for a beacon may stamp its IMU and its fixes by different ones.

#include <sonopose/samples/samples.hpp>
#include "marvelmind/beacon_clock.hpp"
#include "marvelmind/packet.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

namespace sonopose::marvelmind {

/// How beacon time becomes host time.
enum class TimeMapping : std::uint8_t {
  fitted,  ///< `BeaconClock`: by the arrivals, for a live line
  fixed    ///< `FixedClock`: by the beacon's clock alone, for bytes from a file
};

/// How long after emission a position is sent, where it does not say: the format page's typical value.
inline constexpr std::int64_t typical_time_passed_ns = 68'000'000;

/// When a measurement was sent, by the beacon's own clock: its stamp, and how much later it went out.
struct ContentTime {
  Stamp stamp;
  std::optional<std::int64_t> ahead_ns;  ///< empty where the packet does not (credibly) say

  bool operator==(const ContentTime&) const = default;
};

/// An IMU packet is sent at its stamp, a position its time passed after. Nothing for packets without a
/// sample.
std::optional<ContentTime> content_time(const Packet& packet);

/// One time base's clock.
struct ClockTrack {
  std::variant<BeaconClock, FixedClock> clock;
  bool knows_sending = false;  ///< has seen packets that tell when they were sent
};

/// Clocks by time base, each made when its first stamp comes.
class ClockSet {
public:
  explicit ClockSet(TimeMapping mapping) : mapping_(mapping) {}

  /// Shows the clock an arrival. False: the beacon has restarted, and earlier stamps have lost their meaning.
  bool observe(const ContentTime& sent, TimeNs arrival_ns);

  void advance_to(TimeNs now_ns);

  /// Settles all clocks at once.
  void settle();

  /// Can all stamps be mapped?
  bool settled() const;
  std::optional<TimeNs> settles_at_ns() const;

  /// The host's time at a stamp. Needs `settled()`, and an observation in its time base.
  TimeNs host_ns(const Stamp& stamp) const;

  /// Of one time base; zero where nothing came in it.
  double offset_s(TimeBase base) const;
  double jitter_s(TimeBase base) const;

  /// Restarts that were noticed, by the clock that noticed most.
  std::uint64_t resets() const;

private:
  std::optional<ClockTrack>& slot(TimeBase base) { return tracks_[static_cast<std::size_t>(base)]; }
  const std::optional<ClockTrack>& slot(TimeBase base) const {
    return tracks_[static_cast<std::size_t>(base)];
  }
  ClockTrack& track(TimeBase base);

  TimeMapping mapping_;
  std::array<std::optional<ClockTrack>, 3> tracks_;
};

}  // namespace sonopose::marvelmind
