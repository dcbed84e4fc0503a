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

/// How beacon time becomes host time.
enum class TimeMapping : std::uint8_t {
  fitted,  ///< `BeaconClock`: by the arrivals, for a live line
  fixed    ///< `FixedClock`: by the beacon's clock alone, for bytes from a file
};

/// How long after emission a position is sent if its packet does not say: the format's typical value.
inline constexpr std::int64_t typical_time_passed_ns = 68'000'000;

/// When a measurement was sent, by the beacon's own clock: its stamp, and the delay until sending.
struct ContentTime {
  Stamp stamp;
  std::optional<std::int64_t> ahead_ns;  ///< empty if the packet has no plausible value

  bool operator==(const ContentTime&) const = default;
};

/// An IMU packet is sent at its stamp, a position after its time passed. Empty for packets without a sample.
std::optional<ContentTime> content_time(const Packet& packet);

/// One time base's clock.
struct ClockTrack {
  std::variant<BeaconClock, FixedClock> clock;
  bool knows_sending = false;  ///< has observed packets with their sending time
};

/// Clocks by time base, each created on its first stamp.
class ClockSet {
public:
  explicit ClockSet(TimeMapping mapping) : mapping_(mapping) {}

  /// Passes an arrival to its clock. Returns false if the beacon has restarted: earlier stamps are void then.
  bool observe(const ContentTime& sent, TimeNs arrival_ns);

  void advance_to(TimeNs now_ns);

  /// Settles all clocks at once.
  void settle();

  /// Whether all stamps can be mapped.
  bool settled() const;
  std::optional<TimeNs> settles_at_ns() const;

  /// The host's time at a stamp. Needs `settled()`, and an observation in its time base.
  TimeNs host_ns(const Stamp& stamp) const;

  /// Of one time base; zero if it has no stamps.
  double offset_s(TimeBase base) const;
  double jitter_s(TimeBase base) const;

  /// Detected restarts, of the clock with the most.
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
