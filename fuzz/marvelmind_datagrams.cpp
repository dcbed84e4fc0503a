// Decodes and assembles UDP datagrams of a modem. Each datagram follows a byte with its length.

#include "marvelmind/assembler.hpp"
#include "marvelmind/decoder.hpp"
#include "marvelmind/encoder.hpp"
#include "marvelmind_events.hpp"
#include "support.hpp"

#include <algorithm>
#include <span>

using namespace sonopose;
using namespace sonopose::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> rest(data, size);
  marvelmind::DatagramDecoder decoder;
  marvelmind::Assembler assembler;
  EventCheck check;
  TimeNs now_ns = 1'700'000'000'000'000'000;
  std::uint64_t datagrams = 0;
  while (!rest.empty()) {
    const std::size_t length = std::min<std::size_t>(rest.front(), rest.size() - 1);
    const auto datagram = rest.subspan(1, length);
    rest = rest.subspan(1 + length);
    ++datagrams;
    decoder.feed(datagram, [&](const marvelmind::Packet& packet) {
      const marvelmind::Frame again = marvelmind::encode_datagram(packet);
      marvelmind::DatagramDecoder second;
      const marvelmind::Packet* const decoded = second.decode(again.bytes());
      promise(decoded != nullptr && decoded->index() == packet.index(),
              "an encoded datagram keeps its kind of packet");
      check.packet();
      constexpr TimeNs interval_ns = 20'000'000;
      assembler.on(packet, now_ns += interval_ns, check);
    });
  }
  assembler.finish(check);
  check.finish(assembler);
  const auto& counters = decoder.counters();
  promise(counters.frames + counters.unknown_frames + counters.malformed_frames + counters.nmea_datagrams +
                  counters.crc_errors <=
              datagrams,
          "each datagram counts once");
  return 0;
}
