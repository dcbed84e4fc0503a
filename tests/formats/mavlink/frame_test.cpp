#include "mavlink/frame.hpp"

#include "mavlink/messages.hpp"

#include <catch2/catch.hpp>

#include <string_view>
#include <vector>

namespace mavlink_frame_test {

using namespace sonopose;
using mavlink::Decoder;
using mavlink::Frame;
using Bytes = std::vector<std::uint8_t>;

/// CRC-16/MCRF4XX bit by bit, of a text: CRC_EXTRA is made of a message's definition.
std::uint8_t crc_extra(std::string_view definition, const std::vector<std::uint8_t>& more = {}) {
  std::uint32_t crc = 0xFFFF;
  const auto add = [&crc](std::uint8_t byte) {
    for (int bit = 0; bit < 8; ++bit) {
      const bool differs = ((crc ^ (std::uint32_t{byte} >> static_cast<unsigned>(bit))) & 1U) != 0;
      crc = (crc >> 1U) ^ (differs ? 0x8408U : 0U);
    }
  };
  for (const char letter : definition) add(static_cast<std::uint8_t>(letter));
  for (const std::uint8_t byte : more) add(byte);
  return static_cast<std::uint8_t>((crc & 0xFFU) ^ (crc >> 8U));
}

TEST_CASE("The checksum seeds are those of the published definitions") {
  // Name and base fields in the order of the wire, as mavlink.io's "Packet Serialization" makes them.
  CHECK(mavlink::checksum_seed(0) ==
        crc_extra("HEARTBEAT uint32_t custom_mode uint8_t type uint8_t autopilot uint8_t base_mode uint8_t "
                  "system_status uint8_t mavlink_version "));
  CHECK(mavlink::checksum_seed(111) == crc_extra("TIMESYNC int64_t tc1 int64_t ts1 "));
  CHECK(mavlink::checksum_seed(102) ==
        crc_extra("VISION_POSITION_ESTIMATE uint64_t usec float x float y float z float roll float pitch "
                  "float yaw "));
  CHECK_FALSE(mavlink::checksum_seed(1));
}

std::vector<Frame> decoded(Decoder& decoder, const Bytes& bytes) {
  std::vector<Frame> frames;
  decoder.feed(bytes, [&](const Frame& frame) { frames.push_back(frame); });
  return frames;
}

Bytes operator+(Bytes one, const Bytes& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

SCENARIO("frames are found in the bytes of a line") {
  const Bytes heartbeat = encode(mavlink::heartbeat({5, 197}), 42);
  Decoder decoder;
  GIVEN("a heartbeat as it is published: version 2, nine bytes, from system 5") {
    THEN("its header is that of the specification") {
      CHECK(Bytes(heartbeat.begin(), heartbeat.begin() + 10) == Bytes{0xFD, 9, 0, 0, 42, 5, 197, 0, 0, 0});
    }
    THEN("it is decoded again") {
      const auto frames = decoded(decoder, heartbeat);
      REQUIRE(frames.size() == 1);
      CHECK(frames[0].sender == mavlink::Identity{5, 197});
      CHECK(frames[0].size == 9);
    }
    THEN("it is decoded after noise, and byte by byte") {
      for (const std::uint8_t byte : Bytes{7, 3, 1} + heartbeat) decoded(decoder, {byte});
      CHECK(decoder.counters().frames == 1);
      CHECK(decoder.counters().skipped == 3);
    }
    THEN("noise that looks like a start costs less than the longest frame") {
      Bytes bytes{0xFD, 255, 1, 9};
      for (int i = 0; i < 20; ++i) bytes = bytes + heartbeat;
      CHECK(decoded(decoder, bytes).size() >= 20 - 280 / heartbeat.size() - 1);
    }
  }
  GIVEN("datagrams with the beginning of the longest frame, and one with a heartbeat") {
    THEN("the heartbeat is whole, since each datagram is decoded alone") {
      for (int i = 0; i < 3; ++i) {
        CHECK(decoded(decoder, {0xFD, 255, 0}).empty());
        decoder.restart();
      }
      CHECK(decoded(decoder, heartbeat).size() == 1);
      CHECK(decoder.counters().skipped == 9);
    }
  }
  GIVEN("a heartbeat with a wrong byte, then a good one") {
    Bytes damaged = heartbeat;
    damaged[12] ^= 1U;
    THEN("one is counted as damaged, and the other is used") {
      CHECK(decoded(decoder, damaged + heartbeat).size() == 1);
      CHECK(decoder.counters().damaged == 1);
    }
  }
  GIVEN("a heartbeat of version 1 of an ArduPilot (copter, guided)") {
    // Header, payload and checksum.
    const Bytes version_1{0xFE, 9, 78, 1, 1, 0, 4, 0, 0, 0, 2, 3, 89, 3, 3, 0x5D, 0xA6};
    THEN("its sender is an autopilot") {
      const auto frames = decoded(decoder, version_1);
      REQUIRE(frames.size() == 1);
      CHECK(mavlink::autopilot_of(frames[0]) == mavlink::autopilot_ardupilot);
    }
  }
  GIVEN("a message that is not known, with a signature") {
    Bytes unknown{0xFD, 2, 1, 0, 0, 1, 1, 30, 0, 0, 9, 9, 1, 2};
    unknown.insert(unknown.end(), 13, 0);
    THEN("it is skipped as a whole") {
      CHECK(decoded(decoder, unknown + heartbeat).size() == 1);
      CHECK(decoder.counters().unknown == 1);
      CHECK(decoder.counters().skipped == 0);
    }
  }
  GIVEN("a payload that ends with zeros") {
    Frame timesync{.message_id = 111, .sender = {1, 1}};
    timesync.payload[8] = 7;
    timesync.size = 18;
    THEN("they are not sent, and are there again") {
      const Bytes bytes = encode(timesync, 0);
      CHECK(bytes.size() == 10 + 9 + 2);
      const auto frames = decoded(decoder, bytes);
      REQUIRE(frames.size() == 1);
      CHECK(frames[0].payload[8] == 7);
      CHECK(frames[0].payload[17] == 0);
    }
  }
}

}  // namespace mavlink_frame_test
