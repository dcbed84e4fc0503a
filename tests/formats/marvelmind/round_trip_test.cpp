// Round trip of random packets of every kind.

#include "marvelmind/encoder.hpp"
#include "marvelmind/frames.hpp"

#include <catch2/catch.hpp>

#include <limits>
#include <random>

namespace round_trip_test {

using namespace sonopose::marvelmind;
using namespace sonopose::marvelmind::testing;

class RandomPackets {
public:
  explicit RandomPackets(unsigned seed) : random_(seed) {}

  Packet next() {
    switch (random_() % 5) {
      case 0:
        return position();
      case 1:
        return raw_imu();
      case 2:
        return Quality{any<std::uint8_t>(), any<std::uint8_t>(), any<std::uint8_t>()};
      case 3:
        return Telemetry{any<std::uint16_t>(), any<std::int8_t>(), any<std::uint8_t>()};
      default:
        return stationary_beacons();
    }
  }

private:
  /// A random value of the type, often an extreme one.
  template <typename T>
  T any() {
    using Limits = std::numeric_limits<T>;
    const auto kind = random_() % 8;
    if (kind == 0) return Limits::min();
    if (kind == 1) return Limits::max();
    return static_cast<T>(random_());
  }

  bool coin() { return random_() % 2 == 0; }

  template <typename T>
  std::array<T, 3> vector() {
    return {any<T>(), any<T>(), any<T>()};
  }

  Vector3i32 centimetres() {
    return {any<std::int16_t>() * 10, any<std::int16_t>() * 10, any<std::int16_t>() * 10};
  }

  Stamp stamp() {
    if (coin()) return {TimeBase::unix_ms, any<std::int64_t>()};
    return {TimeBase::uptime_ms, any<std::uint32_t>()};
  }

  Position position() {
    Position out;
    out.time = stamp();
    if (out.time.base == TimeBase::uptime_ms && coin()) out.time.base = TimeBase::uptime_64ths;
    out.in_cm = out.time.base != TimeBase::unix_ms && coin();
    out.xyz_mm = out.in_cm ? centimetres() : vector<std::int32_t>();
    out.flags = any<std::uint8_t>() & static_cast<std::uint8_t>(~position_time_in_ms);
    if (out.time.base == TimeBase::uptime_ms) out.flags |= position_time_in_ms;
    out.address = any<std::uint8_t>();
    out.angle.word = any<std::uint16_t>();
    out.time_passed_ms = any<std::uint16_t>();
    if (coin()) out.speed_mmps = vector<std::int16_t>();
    return out;
  }

  RawImu raw_imu() {
    return {.accel = vector<std::int16_t>(),
            .gyro = vector<std::int16_t>(),
            .compass = vector<std::int16_t>(),
            .address = any<std::uint8_t>(),
            .time = stamp(),
            .flags = any<std::uint8_t>()};
  }

  StationaryBeacons stationary_beacons() {
    StationaryBeacons out;
    out.in_cm = coin();
    const auto most = out.in_cm ? StationaryBeacons::max_items_cm : StationaryBeacons::max_items_mm;
    out.count = static_cast<std::uint8_t>(random_() % (most + 1));
    for (StationaryBeacon& beacon : std::span(out.items).first(out.count)) {
      beacon = {any<std::uint8_t>(), out.in_cm ? centimetres() : vector<std::int32_t>(), out.in_cm || coin()};
    }
    return out;
  }

  std::mt19937_64 random_;
};

TEST_CASE("Random packets of every kind come back from a stream as they were sent") {
  RandomPackets packets(1);
  std::vector<Packet> sent;
  Bytes stream;
  for (int i = 0; i < 20000; ++i) {
    sent.push_back(packets.next());
    const Frame frame = encode(sent.back());
    stream.insert(stream.end(), frame.bytes().begin(), frame.bytes().end());
  }
  Decoder decoder;
  const auto received = decode_all(decoder, stream, 1000);
  CHECK(received == sent);
  CHECK(decoder.counters() == DecoderCounters{.frames = sent.size()});
}

TEST_CASE("Random packets of every kind come back from datagrams, but for the reserved bit") {
  RandomPackets packets(2);
  DatagramDecoder decoder;
  std::uint64_t sent = 0;
  for (int i = 0; i < 20000; ++i) {
    Packet packet = packets.next();
    // 0xFF instead of the address is not an address.
    if (auto* position = std::get_if<Position>(&packet)) {
      position->angle.word &= static_cast<std::uint16_t>(~PairAngle::not_applicable);
      if (position->address == 0xFF) position->address = 1;
    }
    const Frame frame = encode_datagram(packet);
    const Packet* received = decoder.decode(frame.bytes());
    ++sent;
    REQUIRE(received != nullptr);
    CHECK(*received == packet);
  }
  CHECK(decoder.counters() == DecoderCounters{.frames = sent});
}

TEST_CASE("Coordinates beyond 16 bits of centimetres saturate") {
  Position far;
  far.in_cm = true;
  far.time = {TimeBase::uptime_ms, 1};
  far.xyz_mm = {1'000'000, -1'000'000, 14};
  const auto packets = decode_all(encode(far).bytes());
  CHECK(std::get<Position>(packets.at(0)).xyz_mm == Vector3i32{327670, -327680, 10});
}

}  // namespace round_trip_test
