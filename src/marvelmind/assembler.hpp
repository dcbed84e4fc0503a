#pragma once
/// \file
/// Packets → the native's samples, for all beacons of a line.

#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>
#include "marvelmind/beacon_assembler.hpp"
#include "marvelmind/event_sink.hpp"
#include "marvelmind/packet.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace sonopose::marvelmind {

/// Sorts packets by beacon address and makes samples of them (see `BeaconAssembler`). Their sequence numbers
/// and `bridge_time_ns` are left to the publisher. Packets that are no sample (the map, distances, the
/// vendor's own fusion, user data) pass without effect. A new address allocates once.
class Assembler {
public:
  explicit Assembler(TimeMapping mapping = TimeMapping::fitted) : mapping_(mapping) {}

  /// Takes a packet. First does what `flush(arrival_ns)` would do.
  void on(const Packet& packet, TimeNs arrival_ns, EventSink sink);

  /// Hands out what has waited long enough: fixes without a quality, packets held for a clock.
  void flush(TimeNs now_ns, EventSink sink);

  /// The end of the input: hands out all that waits.
  void finish(EventSink sink);

  /// When `flush` is due, if no packet comes before.
  std::optional<TimeNs> next_deadline_ns() const;

  /// The arrival to give a packet of a file, by its content: when its beacon sent it, the first one
  /// at `origin_ns`. Packets without a time arrive with the one before; time never goes back. For
  /// TimeMapping::fixed; call it for each packet, in order, before `on`.
  TimeNs replay_arrival_ns(const Packet& packet, TimeNs origin_ns);

  /// The beacons that were heard of, in order of their first packet.
  std::vector<BeaconAddress> addresses() const;

  /// What is known of one beacon; null for one that was never heard.
  const BeaconAssembler* beacon(BeaconAddress address) const;

private:
  BeaconAssembler& beacon_of(std::uint8_t address);

  TimeMapping mapping_;
  std::array<std::unique_ptr<BeaconAssembler>, 256> by_address_;
  std::vector<BeaconAssembler*> in_order_;
  std::optional<TimeNs> replay_reached_ns_;
};

}  // namespace sonopose::marvelmind
