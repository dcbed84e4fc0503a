#pragma once
/// \file
/// Packets → samples, for all beacons of a line.

#include "marvelmind/beacon_assembler.hpp"
#include "marvelmind/event_sink.hpp"
#include "marvelmind/packet.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace sonopose::marvelmind {

/// Sorts packets by beacon address and converts them to samples (see `BeaconAssembler`). The publisher sets
/// their sequence numbers and `bridge_time_ns`. Packets without a sample (the map, distances, the vendor's
/// own fusion, user data) have no effect. Allocates once per new address, of which there are at most 256.
class Assembler {
public:
  explicit Assembler(TimeMapping mapping = TimeMapping::fitted) : mapping_(mapping) {}

  /// Takes a packet, after a `flush(arrival_ns)`.
  void on(const Packet& packet, TimeNs arrival_ns, EventSink sink);

  /// Emits what has waited long enough: fixes without a quality, packets that waited for a clock.
  void flush(TimeNs now_ns, EventSink sink);

  /// Emits everything that waits, at the end of the input.
  void finish(EventSink sink);

  /// Discards what is known of a beacon that is gone, such as its clock.
  void forget(std::uint8_t address);

  /// When `flush` is due if no packet arrives before.
  std::optional<TimeNs> next_deadline_ns() const;

  /// The arrival time to assign to a packet from a file: when its beacon sent it, with the first one at
  /// `origin_ns`. Packets without a time arrive together with the previous one; time never goes back. For
  /// TimeMapping::fixed; call it for each packet, in order, before `on`.
  TimeNs replay_arrival_ns(const Packet& packet, TimeNs origin_ns);

  /// The known beacons, in order of their first packet.
  std::vector<BeaconAddress> addresses() const;

  /// The assembler of one beacon; null if it is unknown.
  const BeaconAssembler* beacon(BeaconAddress address) const;

private:
  BeaconAssembler& beacon_of(std::uint8_t address);

  TimeMapping mapping_;
  std::array<std::unique_ptr<BeaconAssembler>, 256> by_address_;
  std::vector<BeaconAssembler*> in_order_;
  std::optional<TimeNs> replay_reached_ns_;
};

}  // namespace sonopose::marvelmind
