// Decodes and assembles bytes of a serial line or of a raw capture.

#include "marvelmind/assembler.hpp"
#include "marvelmind/crc16.hpp"
#include "marvelmind/decoder.hpp"
#include "marvelmind/encoder.hpp"
#include "marvelmind/foreign_protocol.hpp"
#include "marvelmind_events.hpp"
#include "support.hpp"

#include <algorithm>
#include <span>
#include <string>

using namespace sonopose;
using namespace sonopose::fuzz;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using Bytes = std::span<const std::uint8_t>;

/// Repairs the checksum of every frame: random bytes hardly ever have a valid one.
void repair_checksums(std::span<std::uint8_t> bytes) {
  using namespace marvelmind;
  std::size_t at = 0;
  while (at + header_size + crc_size <= bytes.size()) {
    const std::size_t size = header_size + bytes[at + 4];
    if (bytes[at] != frame_start || at + size + crc_size > bytes.size()) {
      ++at;
      continue;
    }
    const std::uint16_t crc = crc16(bytes.subspan(at, size));
    bytes[at + size] = static_cast<std::uint8_t>(crc & 0xFFU);
    bytes[at + size + 1] = static_cast<std::uint8_t>(crc >> 8U);
    at += size + crc_size;
  }
}

/// Checks that an encoded packet decodes to one packet of the same kind.
void check_round_trip(const marvelmind::Packet& packet) {
  marvelmind::Decoder decoder;
  int packets = 0;
  const marvelmind::Frame frame = marvelmind::encode(packet);
  decoder.feed(frame.bytes(), [&](const marvelmind::Packet& again) {
    promise(again.index() == packet.index(), "an encoded packet keeps its kind");
    ++packets;
  });
  promise(packets == 1, "an encoded packet decodes to one packet");
}

/// Passes the bytes to the decoder in pieces of one size.
marvelmind::DecoderCounters decode(Bytes bytes, std::size_t piece, const auto& on_packet) {
  marvelmind::Decoder decoder;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    decoder.feed(bytes.subspan(at, std::min(piece, bytes.size() - at)), on_packet);
  }
  decoder.finish(on_packet);
  const auto& counters = decoder.counters();
  promise(counters.bytes_lost <= bytes.size(), "no more bytes are lost than arrive");
  promise(counters.frames + counters.unknown_frames + counters.malformed_frames <=
              bytes.size() / (marvelmind::header_size + marvelmind::crc_size),
          "a frame has at least a header and a checksum");
  return counters;
}

}  // namespace

/// The last byte gives the size of the pieces, the interval between them, and the type of clock.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::uint8_t options = data[size - 1];
  const Bytes bytes(data, size - 1);
  const bool fitted = (options & 1U) != 0;
  const std::size_t piece = 1 + std::size_t{options & 0x0EU} * 16U;
  const TimeNs interval_ns = TimeNs{1'000'000} << (options >> 4U);

  marvelmind::Assembler assembler(fitted ? marvelmind::TimeMapping::fitted : marvelmind::TimeMapping::fixed);
  EventCheck check;
  TimeNs now_ns = 1'700'000'000'000'000'000;
  const auto counters = decode(bytes, piece, [&](const marvelmind::Packet& packet) {
    check_round_trip(packet);
    now_ns = fitted ? now_ns + interval_ns : assembler.replay_arrival_ns(packet, now_ns);
    check.packet();
    assembler.on(packet, now_ns, check);
  });
  assembler.finish(check);
  check.finish(assembler);
  const std::string name = marvelmind::foreign_protocol(bytes);
  promise(std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; }),
          "the name of a foreign protocol is printable");
  const auto ignore = [](const marvelmind::Packet&) {};
  promise(counters == decode(bytes, std::max<std::size_t>(bytes.size(), 1), ignore),
          "the pieces in which bytes arrive do not matter");
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  const std::size_t mutated = LLVMFuzzerMutate(data, size, max_size);
  constexpr unsigned broken_one_in = 8;
  if (mutated > 0 && seed % broken_one_in != 0) repair_checksums({data, mutated - 1});
  return mutated;
}
