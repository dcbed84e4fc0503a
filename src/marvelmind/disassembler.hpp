#pragma once
/// \file
/// The native's samples → packets: what a real beacon would have sent.

#include <sonopose/samples/samples.hpp>
#include "marvelmind/event_sink.hpp"
#include "marvelmind/packet.hpp"

#include <cstdint>
#include <optional>

namespace sonopose::marvelmind {

using PacketSink = SinkRef<Packet>;

/// Which firmware the packets are to look like, and what its clock shows.
struct DisassemblerOptions {
  TimeBase time_base = TimeBase::uptime_ms;  ///< unix_ms: firmware from 7.200 on
  /// The host's time at the beacon's zero: of its wake-up for an uptime, 0 for a well synchronised unix time.
  TimeNs beacon_zero_ns = 0;
};

/// Makes packets of one beacon's events; the inverse of `BeaconAssembler`, up to the wire's steps (1 ms, 1
/// mm, 1 mg, 0.0175 deg/s, 0.1°, 1 %). A fix and its heading are one packet on the wire: a fix waits for the
/// event behind it, and its quality follows. A heading without its fix has no packet and is dropped.
class Disassembler {
public:
  explicit Disassembler(const DisassemblerOptions& options) : options_(options) {}

  void on(const Event& event, PacketSink sink);

  /// Sends a fix that still waits for its heading.
  void flush(PacketSink sink);

  /// The beacon's stamp of a moment: the millisecond (or 1/64 s) that has begun.
  Stamp stamp_of(TimeNs time_ns) const;

private:
  void send(const UltrasonicFix& fix, const PairHeading* heading, PacketSink sink) const;

  DisassemblerOptions options_;
  std::optional<UltrasonicFix> waiting_;
};

}  // namespace sonopose::marvelmind
