// The byte stream: chunks of any size, any damage, and no loss of a valid frame.

#include "marvelmind/decoder.hpp"

#include "marvelmind/frames.hpp"

#include <catch2/catch.hpp>

#include <random>

namespace decoder_test {

using namespace sonopose::marvelmind;
using namespace sonopose::marvelmind::testing;

Bytes garbage(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (auto& byte : bytes) {
    // A quarter of the bytes could start a frame.
    constexpr std::array<std::uint8_t, 3> tempting{0xFF, 0x47, 0x4A};
    byte = random() % 4 == 0 ? tempting[random() % 3] : static_cast<std::uint8_t>(random() & 0xFFU);
  }
  return bytes;
}

Bytes payload_of(const Bytes& frame) {
  return {frame.begin() + 5, frame.end() - 2};
}

Bytes with_payload(const Bytes& frame, const Bytes& payload) {
  return with_crc(Bytes{frame[0], frame[1], frame[2], frame[3], static_cast<std::uint8_t>(payload.size())} +
                  payload);
}

TEST_CASE("A frame cut off at any length is dropped without losing the next one") {
  for (const Bytes& frame : all_golden_frames()) {
    for (std::size_t length = 0; length < frame.size(); ++length) {
      const Bytes cut(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(length));
      CHECK(decode_all(cut).empty());

      Decoder decoder;
      const auto packets = decode_all(decoder, cut + quality_frame());
      REQUIRE(packets.size() == 1);
      CHECK(std::get<Quality>(packets[0]) == Quality{7, 90, 2});
      CHECK(decoder.counters().bytes_lost == length);
    }
  }
}

TEST_CASE("A payload shorter than its kind needs is malformed at every length, even with a valid checksum") {
  for (const Bytes& frame : all_golden_frames()) {
    const bool optional_tail = frame == position_real_time_frame();  // optional speed block
    const Bytes payload = payload_of(frame);
    const std::size_t needed = optional_tail ? 26 : payload.size();
    for (std::size_t size = 0; size < needed; ++size) {
      const Bytes shorter(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size));
      Decoder decoder;
      CHECK(decode_all(decoder, with_payload(frame, shorter) + quality_frame()).size() == 1);
      CHECK(decoder.counters() == DecoderCounters{.frames = 1, .malformed_frames = 1});
    }
  }
}

TEST_CASE("A longer payload than its kind needs is accepted") {
  for (const Bytes& frame : all_golden_frames()) {
    const auto expected = decode_all(frame);
    CHECK(decode_all(with_payload(frame, payload_of(frame) + Bytes{0, 0, 0})) == expected);
  }
}

TEST_CASE("A speed block that is truncated or not marked is ignored") {
  const Bytes frame = position_mm_frame();
  const Bytes speed{1, 0x0A, 0x00, 0x14, 0x00, 0x1E, 0x00};
  for (std::size_t size = 0; size <= speed.size(); ++size) {
    const Bytes tail(speed.begin(), speed.begin() + static_cast<std::ptrdiff_t>(size));
    const auto packets = decode_all(with_payload(frame, payload_of(frame) + tail));
    REQUIRE(packets.size() == 1);
    const auto& position = std::get<Position>(packets[0]);
    CHECK(position.xyz_mm == Vector3i32{1000, -2000, 300});
    CHECK(position.speed_mmps.has_value() == (size == speed.size()));
  }
  Bytes unmarked = speed;
  unmarked[0] = 0;
  const auto packets = decode_all(with_payload(frame, payload_of(frame) + unmarked));
  CHECK_FALSE(std::get<Position>(packets.at(0)).speed_mmps);
}

TEST_CASE("Every single flipped bit of a frame is caught") {
  for (const Bytes& frame : all_golden_frames()) {
    for (std::size_t bit = 0; bit < 8 * frame.size(); ++bit) {
      Bytes damaged = frame;
      damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
      Decoder decoder;
      const auto packets = decode_all(decoder, damaged + quality_frame());
      REQUIRE(packets.size() == 1);  // the undamaged frame only
      CHECK(std::get<Quality>(packets[0]) == Quality{7, 90, 2});
      CHECK(decoder.counters().bytes_lost == frame.size());
    }
  }
}

TEST_CASE("Frames with garbage before, between and behind are all found") {
  Bytes stream;
  std::vector<Packet> expected;
  std::size_t lost = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    for (const Bytes& frame : all_golden_frames()) {
      const Bytes noise = garbage(std::size_t{7} * seed, seed);
      lost += noise.size();
      stream = std::move(stream) + noise + frame;
      expected.push_back(decode_all(frame).at(0));
    }
  }
  Decoder decoder;
  CHECK(decode_all(decoder, stream) == expected);
  CHECK(decoder.counters().frames == expected.size());
  CHECK(decoder.counters().bytes_lost == lost);
  CHECK(decoder.counters().unknown_frames == 0);
}

TEST_CASE("Valid frames within a false start are decoded") {
  const Bytes swallowing{0xFF, 0x47, 0x11, 0x00, 0xFF};  // claims 255 bytes of payload
  Bytes stream = swallowing;
  for (int i = 0; i < 10; ++i) stream = std::move(stream) + raw_imu_frame();
  Decoder decoder;
  CHECK(decode_all(decoder, stream).size() == 10);
  CHECK(decoder.counters() == DecoderCounters{.frames = 10, .crc_errors = 1, .bytes_lost = 5});

  SECTION("also where the stream ends inside the swallowed piece") {
    Decoder at_end;
    CHECK(decode_all(at_end, swallowing + raw_imu_frame() + quality_frame()).size() == 2);
    CHECK(at_end.counters() == DecoderCounters{.frames = 2, .bytes_lost = 5});
  }
}

TEST_CASE("A doubled frame start does not hide a frame") {
  for (const Bytes& prefix :
       {Bytes{0xFF}, Bytes{0xFF, 0x47}, Bytes{0xFF, 0xFF, 0xFF}, Bytes{0xFF, 0x4A, 0xFF, 0x47}}) {
    Decoder decoder;
    CHECK(decode_all(decoder, prefix + raw_imu_frame()).size() == 1);
    CHECK(decoder.counters().bytes_lost == prefix.size());
  }
}

TEST_CASE("Pieces of any size give the same packets as the whole") {
  Bytes stream;
  for (unsigned seed = 0; seed < 60; ++seed) {
    for (const Bytes& frame : all_golden_frames()) stream = std::move(stream) + garbage(seed, seed) + frame;
  }
  REQUIRE(stream.size() > 20000);
  Decoder at_once;
  const auto expected = decode_all(at_once, stream);
  for (const std::size_t chunk : {1U, 2U, 3U, 7U, 64U, 261U, 262U, 263U, 4095U, 4096U, 4097U}) {
    Decoder decoder;
    CHECK(decode_all(decoder, stream, chunk) == expected);
    CHECK(decoder.counters() == at_once.counters());
  }
}

TEST_CASE("A packet is emitted with its last byte") {
  const Bytes frame = raw_imu_frame();
  Decoder decoder;
  int packets = 0;
  const auto count = [&packets](const Packet&) { ++packets; };
  decoder.feed(std::span(frame).first(frame.size() - 1), count);
  CHECK(packets == 0);
  decoder.feed(std::span(frame).last(1), count);
  CHECK(packets == 1);
}

TEST_CASE("Frames of known kinds that are not used are counted, and the first kind is named") {
  Decoder decoder;
  Bytes stream = quality_frame();
  for (const Bytes& frame : unused_frames()) stream = std::move(stream) + frame;
  CHECK(decode_all(decoder, stream).size() == 1);
  CHECK(decoder.counters() ==
        DecoderCounters{.frames = 7, .unused_frames = 6, .first_unused = "raw distances"});

  for (const Bytes& frame : unused_frames()) {
    if (frame == unused_frames().back()) continue;  // user data may be shorter
    Bytes shorter = payload_of(frame);
    shorter.pop_back();
    Decoder strict;
    CHECK(decode_all(strict, with_payload(frame, shorter)).empty());
    CHECK(strict.counters() == DecoderCounters{.malformed_frames = 1});
  }
}

TEST_CASE("Valid frames of unknown kind are counted and skipped") {
  const Bytes unknown_code = with_crc({0xFF, 0x47, 0x99, 0x00, 2, 1, 2});
  const Bytes unknown_user_code = with_crc(
      {0xFF, 0x4A, 0x11, 0x00, 22, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  Decoder decoder;
  CHECK(decode_all(decoder, unknown_code + unknown_user_code + quality_frame()).size() == 1);
  CHECK(decoder.counters() == DecoderCounters{.frames = 1, .unknown_frames = 2});
}

}  // namespace decoder_test
