#pragma once
/// \file
/// The way of a packet to the sink, the same for live lines and for files of bytes. Private to this folder.

#include "bridge/step_free_clock.hpp"
#include "marvelmind/assembler.hpp"
#include "marvelmind/decoder.hpp"
#include "publication/source.hpp"

#include <array>
#include <cstdint>

namespace sonopose::bridge {

/// Buffer larger than any frame or datagram.
using Buffer = std::array<std::uint8_t, 4096>;

/// The setting of a beacon that makes it send what a bridge reads.
inline constexpr const char* protocol_setting =
    "the protocol of the beacon's UART and USB output to Marvelmind (Dashboard, Interfaces)";

/// Reports the counters of assembler and decoder for each beacon. `clock`: clock of the arrivals, if the
/// host's clock can be set meanwhile.
void report(const marvelmind::Assembler& assembler, const marvelmind::DecoderCounters& line,
            publication::SampleSink& sink, const StepFreeClock* clock = nullptr);

/// Passes an event on. IMU samples get the meaning that the user declares.
void pass_on(Event event, ImuMeaning imu_meaning, publication::SampleSink& sink);

/// Passes on the stationary beacons of a map packet; ignores other packets.
void pass_on_map(const marvelmind::Packet& packet, TimeNs received_ns, publication::SampleSink& sink);

}  // namespace sonopose::bridge
