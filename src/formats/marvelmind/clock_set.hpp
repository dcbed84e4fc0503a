#pragma once
/// \file
/// The clocks of one beacon, one per time base: a beacon may stamp its IMU and its fixes by different ones.

#include "marvelmind/beacon_clock.hpp"
#include "marvelmind/packet.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

namespace sonopose::marvelmind {

/// The method that converts beacon time to host time.
enum class TimeMapping : std::uint8_t {
  fitted,  ///< `BeaconClock`: by the arrivals, for a live line
  fixed    ///< `FixedClock`: by the beacon's clock alone, for bytes from a file
};

/// Typical delay from emission to sending, for a position whose packet does not state it.
inline constexpr std::int64_t typical_time_passed_ns = 68'000'000;

/// The sending time of a measurement by the beacon's own clock: its stamp, and the delay until sending.
struct ContentTime {
  Stamp stamp;
  std::optional<std::int64_t> send_delay_ns;  ///< delay; empty if the packet has no plausible value

  bool operator==(const ContentTime&) const = default;
};

/// An IMU packet is sent at its stamp, a position after its time passed. Empty for packets without a sample.
std::optional<ContentTime> content_time(const Packet& packet);

/// The steps of a beacon's clock, which was set or restarted.
struct ClockSteps {
  std::uint64_t count = 0;
  std::int64_t newest_ns = 0;  ///< size of the newest one; negative: back
};

/// The clock of one time base.
struct ClockTrack {
  std::variant<BeaconClock, FixedClock> clock;
  bool knows_sending = false;  ///< true after a packet with its sending time
};

/// Clocks by time base, each created on its first stamp.
class ClockSet {
public:
  explicit ClockSet(TimeMapping mapping) : mapping_(mapping) {}

  /// Passes an arrival to its clock. Returns false if the beacon has restarted, which invalidates earlier
  /// stamps.
  bool observe(const ContentTime& sent, TimeNs arrival_ns);

  void advance_to(TimeNs now_ns);

  /// Settles all clocks immediately.
  void settle();

  /// True if all stamps can be mapped.
  bool settled() const;
  std::optional<TimeNs> settles_at_ns() const;

  /// The host's time at a stamp. Needs `settled()`, and an observation in its time base.
  TimeNs host_ns(const Stamp& stamp) const;

  /// The values of one time base; zero if it has no stamps.
  double offset_s(TimeBase base) const;
  double jitter_s(TimeBase base) const;

  /// Number of detected restarts of the clock that has most of them.
  std::uint64_t resets() const;

  /// The steps of the clock that has most of them.
  ClockSteps steps() const;

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
