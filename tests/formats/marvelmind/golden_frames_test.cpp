// Every packet of the format's table as literal bytes.

#include "marvelmind/crc16.hpp"
#include "marvelmind/encoder.hpp"
#include "marvelmind/frames.hpp"

#include <catch2/catch.hpp>

namespace golden_frames_test {

using namespace sonopose::marvelmind;
using namespace sonopose::marvelmind::testing;

constexpr std::int64_t unix_ms = 1700000000123;

template <typename Kind>
Kind decode_one(const Bytes& frame) {
  const auto packets = decode_all(frame);
  REQUIRE(packets.size() == 1);
  REQUIRE(std::holds_alternative<Kind>(packets.front()));
  return std::get<Kind>(packets.front());
}

TEST_CASE("The checksum is CRC-16/MODBUS") {
  // The catalogue's check value for the ASCII digits 1 to 9.
  constexpr std::array<std::uint8_t, 9> digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  static_assert(crc16(digits) == 0x4B37);
  for (const Bytes& frame : all_golden_frames()) CHECK(crc16(frame) == 0);
}

TEST_CASE("Positions of all three kinds are read from their table") {
  SECTION("0x0001, centimetres, 1/64 s") {
    const auto position = decode_one<Position>(position_cm_frame());
    CHECK(position.time == Stamp{TimeBase::uptime_64ths, 0x10000});
    CHECK(position.in_cm);
    CHECK(position.xyz_mm == Vector3i32{1230, -4560, 70});
    CHECK(position.address == 5);
    CHECK(position.angle.yaw_decideg() == 900);
    CHECK(position.angle.is_applicable());
    CHECK_FALSE(position.angle.is_pair_centre());
    CHECK(position.time_passed_ms == 70);
    CHECK(position.is_available());
    CHECK_FALSE(position.speed_mmps);
  }
  SECTION("0x0011, millimetres, ms") {
    const auto position = decode_one<Position>(position_mm_frame());
    CHECK(position.time == Stamp{TimeBase::uptime_ms, 0xFFFFFFFE});
    CHECK(position.xyz_mm == Vector3i32{1000, -2000, 300});
    CHECK(position.flags == (position_time_in_ms | position_user_button_1));
    CHECK(position.address == 7);
    CHECK(position.angle.yaw_decideg() == 3599);
    CHECK(position.angle.is_pair_centre());
    CHECK(position.time_passed_ms == 68);
  }
  SECTION("0x0081, real time, with speed") {
    const auto position = decode_one<Position>(position_real_time_frame());
    CHECK(position.time == Stamp{TimeBase::unix_ms, unix_ms});
    CHECK(position.xyz_mm == Vector3i32{-1, 70000, 0});
    CHECK(position.flags == (position_time_in_ms | position_other_hedge));
    CHECK_FALSE(position.angle.is_applicable());
    CHECK(position.time_passed_ms == 255);
    CHECK(position.speed_mmps == Vector3i16{100, -200, 1});
  }
}

TEST_CASE("Maps of stationary beacons are read from their tables") {
  const auto cm = decode_one<StationaryBeacons>(stationary_cm_frame());
  REQUIRE(cm.beacons().size() == 2);
  CHECK(cm.beacons()[0] == StationaryBeacon{2, {1000, 2000, 3000}, true});
  CHECK(cm.beacons()[1] == StationaryBeacon{3, {-1000, 0, 0}, true});

  const auto mm = decode_one<StationaryBeacons>(stationary_mm_frame());
  REQUIRE(mm.beacons().size() == 2);
  CHECK(mm.beacons()[0] == StationaryBeacon{2, {1000, 2000, -1}, true});
  CHECK(mm.beacons()[1] == StationaryBeacon{4, {0, 0, 0}, false});
}

TEST_CASE("Raw IMU packets of both generations are read from their tables") {
  const auto uptime = decode_one<RawImu>(raw_imu_frame());
  const auto real_time = decode_one<RawImu>(raw_imu_real_time_frame());
  for (const RawImu& imu : {uptime, real_time}) {
    CHECK(imu.accel == Vector3i16{1, -2, 1000});
    CHECK(imu.gyro == Vector3i16{1, -1, 100});
    CHECK(imu.compass == Vector3i16{1100, -1100, 980});
    CHECK(imu.address == 7);
  }
  CHECK(uptime.time == Stamp{TimeBase::uptime_ms, 305419896});
  CHECK(uptime.flags == imu_compass_not_available);
  CHECK(real_time.time == Stamp{TimeBase::unix_ms, unix_ms});
  CHECK(real_time.flags == 0);
}

TEST_CASE("Telemetry and quality are read from their tables") {
  CHECK(decode_one<Telemetry>(telemetry_frame()) == Telemetry{3870, -71, 7});
  CHECK(decode_one<Quality>(quality_frame()) == Quality{7, 90, 2});
}

TEST_CASE("The encoder reproduces every golden frame") {
  for (const Bytes& frame : all_golden_frames()) {
    if (frame == raw_imu_frame()) continue;  // its reserved bytes are nonzero
    const auto packets = decode_all(frame);
    REQUIRE(packets.size() == 1);
    const Frame again = encode(packets.front());
    CHECK(Bytes(again.bytes().begin(), again.bytes().end()) == frame);
  }
}

}  // namespace golden_frames_test
