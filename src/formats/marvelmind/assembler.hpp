#pragma once
/// \file
/// Converts packets of all beacons of a line to samples.

#include "marvelmind/beacon_assembler.hpp"
#include "marvelmind/packet.hpp"
#include "marvelmind/sink_ref.hpp"
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

  /// Calls `flush(arrival_ns)`, then takes a packet.
  void on(const Packet& packet, TimeNs arrival_ns, EventSink sink);

  /// Emits samples whose waiting time is over: fixes without a quality, packets that waited for a clock.
  void flush(TimeNs now_ns, EventSink sink);

  /// Emits all waiting samples, at the end of the input.
  void finish(EventSink sink);

  /// Discards the state of a beacon that is gone, such as its clock.
  void forget(std::uint8_t address);

  /// Time at which `flush` is due if no packet arrives before.
  std::optional<TimeNs> next_deadline_ns() const;

  /// Returns the arrival time for a packet from a file: its sending time, with the first packet at
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
