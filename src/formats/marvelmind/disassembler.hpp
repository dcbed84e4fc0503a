#pragma once
/// \file
/// Converts samples to packets, as a real beacon would have sent them.

#include "marvelmind/packet.hpp"
#include "marvelmind/sink_ref.hpp"
#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::marvelmind {

using PacketSink = SinkRef<Packet>;

/// The firmware generation to imitate, and its clock.
struct DisassemblerOptions {
  TimeBase time_base = TimeBase::uptime_ms;  ///< unix_ms: firmware from 7.200 on
  /// Host time at the beacon's zero: its wake-up for an uptime, 0 for a synchronised unix time.
  TimeNs beacon_zero_ns = 0;
};

/// Converts one beacon's events to packets; the inverse of `BeaconAssembler`, up to the wire's steps (1 ms, 1
/// mm, 1 mg, 0.0175 deg/s, 0.1°, 1 %). A fix and its heading share one packet, so a fix waits for the next
/// event. Its quality follows. A heading without its fix has no packet and is dropped.
class Disassembler {
public:
  explicit Disassembler(const DisassemblerOptions& options) : options_(options) {}

  void on(const Event& event, PacketSink sink);

  /// Emits a fix that still waits for its heading.
  void flush(PacketSink sink);

  /// Returns the beacon's stamp of a time, rounded down to milliseconds (or 1/64 s).
  Stamp stamp_of(TimeNs time_ns) const;

private:
  void send(const UltrasonicFix& fix, const PairHeading* heading, PacketSink sink) const;

  DisassemblerOptions options_;
  std::optional<UltrasonicFix> waiting_;
};

}  // namespace sonopose::marvelmind
