// The UDP variant: an address instead of 0xFF, optional checksum, NMEA sentences in between.

#include "marvelmind/encoder.hpp"
#include "marvelmind/frames.hpp"

#include <catch2/catch.hpp>

namespace datagrams_test {

using namespace sonopose::marvelmind;
using namespace sonopose::marvelmind::testing;

/// The golden position 0x0011 as a datagram of beacon 12.
Bytes position_datagram() {
  Bytes bytes = position_mm_frame();
  bytes.resize(bytes.size() - 2);
  bytes[0] = 12;
  bytes[5 + 17] = 0;
  return bytes;
}

TEST_CASE("A position's datagram contains the address in its first byte") {
  DatagramDecoder decoder;
  const Packet* packet = decoder.decode(position_datagram());
  REQUIRE(packet != nullptr);
  const auto& position = std::get<Position>(*packet);
  CHECK(position.address == 12);
  CHECK(position.xyz_mm == Vector3i32{1000, -2000, 300});
}

TEST_CASE("A datagram needs no checksum, and bytes after the payload are ignored") {
  for (const Bytes& tail : {Bytes{}, Bytes{0x12}, Bytes{0x12, 0x34}, Bytes(40, 0xEE)}) {
    DatagramDecoder decoder;
    CHECK(decoder.decode(position_datagram() + tail) != nullptr);
    CHECK(decoder.counters() == DecoderCounters{.frames = 1});
  }
}

TEST_CASE("A datagram that is cut off is lost, at every length") {
  const Bytes whole = position_datagram();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    DatagramDecoder decoder;
    CHECK(decoder.decode(std::span(whole).first(length)) == nullptr);
    CHECK(decoder.counters() == DecoderCounters{.bytes_lost = length});
  }
}

TEST_CASE("Angle bit 13 is reserved over UDP and does not invalidate the heading") {
  Bytes bytes = position_datagram();
  bytes[5 + 19] |= 0x20;
  DatagramDecoder decoder;
  const Packet* packet = decoder.decode(bytes);
  REQUIRE(packet != nullptr);
  const PairAngle angle = std::get<Position>(*packet).angle;
  CHECK(angle.is_applicable());
  CHECK(angle.is_pair_centre());
  CHECK(angle.yaw_decideg() == 3599);
}

TEST_CASE("Packets that begin with 0xFF over UDP keep the address in their payload") {
  DatagramDecoder decoder;
  const Packet* packet = decoder.decode(quality_frame());
  REQUIRE(packet != nullptr);
  CHECK(std::get<Quality>(*packet).address == 7);
  packet = decoder.decode(stationary_mm_frame());
  REQUIRE(packet != nullptr);
  CHECK(std::get<StationaryBeacons>(*packet).count == 2);
  for (const Bytes& frame : unused_frames()) CHECK(decoder.decode(frame) == nullptr);
  CHECK(decoder.counters() ==
        DecoderCounters{.frames = 8, .unused_frames = 6, .first_unused = "raw distances"});
}

TEST_CASE("NMEA sentences are ignored and counted") {
  const std::string_view sentence = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
  const Bytes bytes(sentence.begin(), sentence.end());
  DatagramDecoder decoder;
  CHECK(decoder.decode(bytes) == nullptr);
  CHECK(decoder.counters() == DecoderCounters{.nmea_datagrams = 1});
}

TEST_CASE("Datagrams of unknown kinds, or too short for their kind, are counted") {
  DatagramDecoder decoder;
  CHECK(decoder.decode(Bytes{7, 0x47, 0x99, 0x00, 1, 0}) == nullptr);
  CHECK(decoder.decode(Bytes{7, 0x47, 0x11, 0x00, 3, 0, 0, 0}) == nullptr);
  CHECK(decoder.decode(Bytes{7, 0x48, 0x11, 0x00, 0}) == nullptr);
  CHECK(decoder.counters() == DecoderCounters{.bytes_lost = 5, .unknown_frames = 1, .malformed_frames = 1});
}

TEST_CASE("The encoder's datagram of a position is the one written by hand") {
  auto position = std::get<Position>(decode_all(position_mm_frame()).at(0));
  position.address = 12;
  const Frame datagram = encode_datagram(position);
  CHECK(Bytes(datagram.bytes().begin(), datagram.bytes().end()) == position_datagram());
}

}  // namespace datagrams_test
