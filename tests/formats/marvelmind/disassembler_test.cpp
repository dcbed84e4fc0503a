// Samples to packets to bytes and back: only the resolution of the format is lost.

#include "marvelmind/disassembler.hpp"

#include "marvelmind/assembler.hpp"
#include "marvelmind/conversions.hpp"
#include "marvelmind/encoder.hpp"
#include "marvelmind/frames.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace disassembler_test {

using namespace sonopose;
using namespace sonopose::marvelmind;

constexpr TimeNs wake_up_ns = 1'700'000'000'000'000'000;

/// Ten seconds of a beacon: IMU at 100 Hz, a fix with heading every 85 ms.
std::vector<Event> some_events() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto vector = [&](double size) {
    return Vector3d(size * Vector3d::NullaryExpr([&] { return any(random); }));
  };
  std::vector<Event> events;
  for (int i = 1; i <= 1000; ++i) {
    const TimeNs now_ns = wake_up_ns + i * TimeNs{10'000'000};
    ImuSample imu;
    imu.address = 7;
    imu.sensor_time_ns = now_ns;
    imu.angular_velocity_body_radps = vector(8);
    imu.specific_force_body_mps2 = vector(40);
    if (i % 2 == 0) imu.magnetic_field_body_t = vector(60e-6);
    events.emplace_back(imu);
    if (i % 9 != 0) continue;
    UltrasonicFix fix;
    fix.address = 7;
    fix.emission_time_ns = now_ns - 68'000'000;
    fix.received_time_ns = now_ns;
    fix.position_world_m = vector(50);
    fix.quality_percent = std::round(50 + 50 * any(random));
    fix.measured_delay_s = 0.068;
    fix.flags = i % 2 == 0 ? ultrasonic_flag_pair_centre | ultrasonic_flag_user_button_2
                           : ultrasonic_flag_out_of_geofence;
    PairHeading heading;
    heading.address = 7;
    heading.emission_time_ns = fix.emission_time_ns;
    heading.received_time_ns = fix.received_time_ns;
    heading.valid = i % 27 != 0;
    if (heading.valid) heading.heading_world_rad = std::numbers::pi * (1 + any(random));
    events.emplace_back(fix);
    events.emplace_back(heading);
  }
  return events;
}

struct ExpectSame {
  void operator()(const ImuSample& sent, const ImuSample& received) const {
    CHECK((sent.specific_force_body_mps2 - received.specific_force_body_mps2).cwiseAbs().maxCoeff() <=
          accel_mps2_per_lsb / 2 + 1e-12);
    CHECK((sent.angular_velocity_body_radps - received.angular_velocity_body_radps).cwiseAbs().maxCoeff() <=
          gyro_radps_per_lsb / 2 + 1e-12);
    REQUIRE(sent.magnetic_field_body_t.has_value() == received.magnetic_field_body_t.has_value());
    const Vector3d sent_t = sent.magnetic_field_body_t.value_or(Vector3d::Zero());
    const Vector3d received_t = received.magnetic_field_body_t.value_or(Vector3d::Zero());
    CHECK((sent_t - received_t).cwiseAbs().maxCoeff() <= compass_z_t_per_lsb / 2 + 1e-15);
  }
  void operator()(const UltrasonicFix& sent, const UltrasonicFix& received) const {
    CHECK((sent.position_world_m - received.position_world_m).cwiseAbs().maxCoeff() <= 0.5e-3 + 1e-9);
    CHECK(sent.quality_percent == received.quality_percent);
    CHECK(*sent.measured_delay_s == Approx(*received.measured_delay_s));
    CHECK(sent.flags == received.flags);
    CHECK(sent.emission_time_ns == received.emission_time_ns);
    CHECK(sent.received_time_ns == received.received_time_ns);
  }
  void operator()(const PairHeading& sent, const PairHeading& received) const {
    CHECK(sent.valid == received.valid);
    const double apart_rad =
        std::remainder(sent.heading_world_rad - received.heading_world_rad, 2 * std::numbers::pi);
    CHECK(std::abs(apart_rad) <= 0.05 * std::numbers::pi / 180 + 1e-12);
    CHECK(sent.emission_time_ns == received.emission_time_ns);
  }
  template <typename A, typename B>
  void operator()(const A&, const B&) const {
    FAIL("another kind of event came back");
  }
};

TEST_CASE("Events come back from the bytes that a beacon would have sent for them") {
  const auto time_base = GENERATE(TimeBase::uptime_ms, TimeBase::unix_ms);
  const TimeNs zero_ns = time_base == TimeBase::uptime_ms ? wake_up_ns : 0;
  const auto sent = some_events();

  marvelmind::testing::Bytes stream;
  Disassembler disassembler({.time_base = time_base, .beacon_zero_ns = zero_ns});
  const auto write = [&stream](const Packet& packet) {
    const Frame frame = encode(packet);
    stream.insert(stream.end(), frame.bytes().begin(), frame.bytes().end());
  };
  for (const Event& event : sent) disassembler.on(event, write);
  disassembler.flush(write);

  std::vector<Event> received;
  const auto collect = [&received](const Event& event) { received.push_back(event); };
  Assembler assembler(TimeMapping::fixed);
  Decoder decoder;
  decoder.feed(stream, [&](const Packet& packet) {
    assembler.on(packet, assembler.replay_arrival_ns(packet, wake_up_ns + 10'000'000), collect);
  });
  assembler.finish(collect);

  REQUIRE(received.size() == sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) std::visit(ExpectSame{}, sent[i], received[i]);
}

TEST_CASE("Values beyond the wire's range saturate, and NaN becomes zero") {
  ImuSample sample;
  sample.specific_force_body_mps2 = {1e9, -1e9, std::nan("")};
  sample.magnetic_field_body_t = Vector3d(1, 0, 0);
  const RawImu imu = to_raw_imu(sample, {});
  CHECK(imu.accel == Vector3i16{32767, -32768, 0});
  CHECK(imu.compass == Vector3i16{32767, 0, 0});
  UltrasonicFix fix;
  fix.position_world_m = {1e12, -1e12, 0};
  fix.measured_delay_s = 1e6;
  const Position position = to_position(fix, nullptr, {});
  CHECK(position.xyz_mm == Vector3i32{INT32_MAX, INT32_MIN, 0});
  CHECK(position.time_passed_ms == 65535);
}

TEST_CASE("Headings of any turn are sent as decidegrees below 360") {
  const auto sent_as = [](double deg) {
    const PairHeading heading{.heading_world_rad = deg * std::numbers::pi / 180, .valid = true};
    return to_position({}, &heading, {}).angle.yaw_decideg();
  };
  CHECK(sent_as(0) == 0);
  CHECK(sent_as(93.5) == 935);
  CHECK(sent_as(-90) == 2700);
  CHECK(sent_as(359.96) == 0);
  CHECK(sent_as(725) == 50);
}

TEST_CASE("A fix without a heading says that its orientation does not apply") {
  Disassembler disassembler({});
  std::vector<Packet> packets;
  const auto collect = [&packets](const Packet& packet) { packets.push_back(packet); };
  UltrasonicFix fix;
  fix.address = 7;
  disassembler.on(fix, collect);
  CHECK(packets.empty());
  disassembler.on(ImuSample{}, collect);
  REQUIRE(packets.size() == 2);
  CHECK_FALSE(std::get<Position>(packets[0]).angle.is_applicable());
  CHECK(std::holds_alternative<RawImu>(packets[1]));
}

TEST_CASE("An uptime wraps as the beacon's counter does") {
  const Disassembler disassembler({.beacon_zero_ns = wake_up_ns});
  const TimeNs wrap_ns = wake_up_ns + (TimeNs{1} << 32) * 1'000'000;
  CHECK(disassembler.stamp_of(wrap_ns - 1).ticks == 0xFFFFFFFF);
  CHECK(disassembler.stamp_of(wrap_ns).ticks == 0);
}

}  // namespace disassembler_test
