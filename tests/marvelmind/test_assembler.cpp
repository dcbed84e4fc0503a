// Packets → samples: units, flags, the wait for quality, two generations at once, what is kept back.

#include "frames.hpp"
#include <sonopose/marvelmind/assembler.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <numbers>
#include <vector>

using namespace sonopose;
using namespace sonopose::marvelmind;

namespace {

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

/// An assembler by the beacon's own clock, so that times are exact: the beacon's uptime 1000 ms is
/// `start_ns`.
struct Fixture {
  explicit Fixture(TimeMapping mapping = TimeMapping::fixed) : assembler(mapping) {}

  Assembler assembler;
  std::vector<Event> events;

  void on(const Packet& packet, std::int64_t arrival_ms) {
    assembler.on(packet, start_ns + arrival_ms * ms, [this](const Event& event) { events.push_back(event); });
  }
  void flush(std::int64_t now_ms) {
    assembler.flush(start_ns + now_ms * ms, [this](const Event& event) { events.push_back(event); });
  }
  void finish() {
    assembler.finish([this](const Event& event) { events.push_back(event); });
  }
  const AssemblerCounters& counters() const { return assembler.beacon(7)->counters(); }

  template <typename Sample>
  std::vector<Sample> all() const {
    std::vector<Sample> found;
    for (const Event& event : events) {
      if (const auto* sample = std::get_if<Sample>(&event)) found.push_back(*sample);
    }
    return found;
  }
};

RawImu imu_at(std::int64_t uptime_ms) {
  RawImu imu;
  imu.address = 7;
  imu.time = {TimeBase::uptime_ms, 1000 + uptime_ms};
  imu.accel = {0, 0, 1000};
  imu.flags = imu_compass_not_available;
  return imu;
}

Position position_at(std::int64_t uptime_ms, std::uint16_t time_passed_ms = 68) {
  Position position;
  position.address = 7;
  position.time = {TimeBase::uptime_ms, 1000 + uptime_ms};
  position.flags = position_time_in_ms;
  position.xyz_mm = {1000, -2000, 300};
  position.angle.word = 900;
  position.time_passed_ms = time_passed_ms;
  return position;
}

Position in_real_time(Position position) {
  constexpr std::int64_t wake_up_unix_ms = 1'600'000'000'000;
  position.time = {TimeBase::unix_ms, wake_up_unix_ms + position.time.ticks};
  return position;
}

RawImu in_real_time(RawImu imu) {
  imu.time = {TimeBase::unix_ms, 1'600'000'000'000 + imu.time.ticks};
  return imu;
}

Position in_centimetres(Position position) {
  position.in_cm = true;
  return position;
}

}  // namespace

TEST_CASE("Raw IMU units become SI units") {
  Fixture f;
  RawImu imu = imu_at(0);
  imu.accel = {1000, -1, 0};
  imu.gyro = {100, -1, 0};
  imu.compass = {1100, -1100, 980};
  imu.flags = 0;
  f.on(imu, 3);
  const auto sample = f.all<ImuSample>().at(0);
  CHECK(sample.address == 7);
  CHECK(sample.sequence == 0);
  CHECK(sample.specific_force_body_mps2.isApprox(Vector3d(9.80665, -0.00980665, 0), 1e-12));
  CHECK(sample.angular_velocity_body_radps.isApprox(Vector3d(1.75, -0.0175, 0) * std::numbers::pi / 180,
                                                    1e-12));
  REQUIRE(sample.magnetic_field_body_t);
  CHECK(sample.magnetic_field_body_t->isApprox(Vector3d(1e-4, -1e-4, 1e-4), 1e-12));  // one gauss each
}

TEST_CASE("What the IMU flags as not available is kept back") {
  Fixture f;
  RawImu imu = imu_at(0);
  imu.compass = {1, 2, 3};
  SECTION("the compass: a sample without it") {
    f.on(imu, 0);
    REQUIRE(f.all<ImuSample>().size() == 1);
    CHECK_FALSE(f.all<ImuSample>()[0].magnetic_field_body_t);
  }
  SECTION("a compass of zeros is none") {
    imu.compass = {};
    imu.flags = 0;
    f.on(imu, 0);
    CHECK_FALSE(f.all<ImuSample>().at(0).magnetic_field_body_t);
  }
  SECTION("accelerometer or gyro: no sample, counted") {
    imu.flags = imu_accel_not_available;
    f.on(imu, 0);
    imu.flags = imu_gyro_not_available;
    f.on(imu, 10);
    CHECK(f.events.empty());
    CHECK(f.counters().imu_unavailable == 2);
  }
}

TEST_CASE("IMU samples that share a stamp are all passed on") {
  Fixture f;
  for (std::int64_t i = 0; i < 3; ++i) f.on(imu_at(10), 10 + i);
  CHECK(f.all<ImuSample>().size() == 3);
}

TEST_CASE("A position becomes a fix and the pair's heading, at the time of emission") {
  Fixture f;
  f.on(imu_at(0), 0);  // sent at its stamp: uptime 1000 ms is start_ns
  f.on(position_at(100), 168);
  f.finish();
  REQUIRE(f.events.size() == 3);
  const auto& fix = std::get<UltrasonicFix>(f.events[1]);
  CHECK(fix.address == 7);
  CHECK(fix.emission_time_ns == start_ns + 100 * ms);
  CHECK(fix.received_time_ns == start_ns + 168 * ms);
  CHECK(fix.position_world_m.isApprox(Vector3d(1, -2, 0.3), 1e-12));
  CHECK(fix.measured_delay_s == Approx(0.068));
  CHECK_FALSE(fix.quality_percent);
  CHECK(fix.flags == 0);
  const auto& heading = std::get<PairHeading>(f.events[2]);
  CHECK(heading.valid);
  CHECK(heading.heading_world_rad == Approx(std::numbers::pi / 2));
  CHECK(heading.emission_time_ns == fix.emission_time_ns);
  CHECK(heading.received_time_ns == fix.received_time_ns);
}

TEST_CASE("A position's flags and angle bits reach the samples") {
  Fixture f;
  Position position = position_at(0, 0);
  position.flags |=
      position_user_button_1 | position_user_button_2 | position_other_hedge | position_out_of_geofence;
  position.angle.word = PairAngle::pair_centre | PairAngle::not_applicable | 450;
  f.on(position, 68);
  f.finish();
  const auto fix = f.all<UltrasonicFix>().at(0);
  CHECK(fix.flags == (fix_flag_user_button_1 | fix_flag_user_button_2 | fix_flag_other_hedge |
                      fix_flag_out_of_geofence | fix_flag_pair_centre));
  CHECK_FALSE(fix.measured_delay_s);
  CHECK_FALSE(f.all<PairHeading>().at(0).valid);
}

TEST_CASE("Positions of old firmware are stamped in 1/64 s") {
  Fixture f;
  Position position = position_at(0, 70);
  position.flags = 0;
  position.time = {TimeBase::uptime_64ths, 640};
  f.on(position, 70);
  position.time.ticks += 8;  // 125 ms
  f.on(position, 195);
  f.finish();
  const auto fixes = f.all<UltrasonicFix>();
  REQUIRE(fixes.size() == 2);
  CHECK(fixes[1].emission_time_ns - fixes[0].emission_time_ns == 125 * ms);
  CHECK(fixes[0].flags == fix_flag_second_resolution);
}

TEST_CASE("Nothing is published for a position that is not available") {
  Fixture f;
  Position position = position_at(0);
  position.flags |= position_not_available;
  f.on(position, 68);
  f.on(Quality{7, 90, 0}, 69);
  f.finish();
  CHECK(f.events.empty());
  CHECK(f.counters().fixes_unavailable == 1);
  CHECK(f.assembler.beacon(7)->status().fixes_unavailable == 1);
}

TEST_CASE("A fix waits for its quality") {
  Fixture f;
  f.on(imu_at(60), 60);
  f.on(position_at(0), 68);
  REQUIRE(f.all<UltrasonicFix>().empty());
  CHECK(f.assembler.next_deadline_ns() == start_ns + 78 * ms);

  SECTION("which comes: the fix goes out with it, the heading behind") {
    f.on(imu_at(70), 70);
    CHECK(f.all<ImuSample>().size() == 2);  // passes the waiting fix
    f.on(Quality{7, 90, 0}, 72);
    REQUIRE(f.events.size() == 4);
    CHECK(std::get<UltrasonicFix>(f.events[2]).quality_percent == 90.0);
    CHECK(std::get<UltrasonicFix>(f.events[2]).received_time_ns == start_ns + 68 * ms);
    CHECK(std::holds_alternative<PairHeading>(f.events[3]));
    CHECK_FALSE(f.assembler.next_deadline_ns());
  }
  SECTION("for 10 ms, not longer") {
    f.flush(77);
    CHECK(f.all<UltrasonicFix>().empty());
    f.flush(78);
    REQUIRE(f.all<UltrasonicFix>().size() == 1);
    CHECK_FALSE(f.all<UltrasonicFix>()[0].quality_percent);
    f.on(Quality{7, 90, 0}, 79);
    CHECK(f.all<UltrasonicFix>().size() == 1);
    CHECK(f.counters().quality_without_fix == 1);
  }
  SECTION("a packet that comes after the 10 ms lets it go first") {
    f.on(imu_at(79), 79);
    REQUIRE(f.events.size() == 4);
    CHECK(std::holds_alternative<UltrasonicFix>(f.events[1]));
    CHECK(std::holds_alternative<ImuSample>(f.events[3]));
  }
  SECTION("until the next fix") {
    f.on(position_at(5), 73);
    REQUIRE(f.all<UltrasonicFix>().size() == 1);
    f.on(Quality{7, 80, 0}, 74);
    const auto fixes = f.all<UltrasonicFix>();
    REQUIRE(fixes.size() == 2);
    CHECK_FALSE(fixes[0].quality_percent);
    CHECK(fixes[1].quality_percent == 80.0);
  }
  SECTION("and does not take that of a later position that is not available") {
    Position position = position_at(5);
    position.flags |= position_not_available;
    f.on(position, 73);
    f.on(Quality{7, 10, 0}, 74);
    const auto fixes = f.all<UltrasonicFix>();
    REQUIRE(fixes.size() == 1);
    CHECK_FALSE(fixes[0].quality_percent);
  }
  SECTION("nor another beacon's") {
    f.on(Quality{8, 50, 0}, 69);
    CHECK(f.all<UltrasonicFix>().empty());
  }
}

TEST_CASE("One emission in two kinds of packet is one fix, of the better kind") {
  Fixture f(GENERATE(TimeMapping::fixed, TimeMapping::fitted));
  const bool better_first = GENERATE(true, false);
  for (std::int64_t i = 0; i < 100; ++i) {
    const std::int64_t uptime_ms = 85 * i;
    const Position old_kind = position_at(uptime_ms);
    const std::vector<Position> kinds{in_real_time(old_kind), old_kind, in_centimetres(old_kind)};
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      f.on(kinds[better_first ? k : kinds.size() - 1 - k], uptime_ms + 68 + static_cast<std::int64_t>(k));
    }
    f.on(Quality{7, 90, 0}, uptime_ms + 72);
  }
  f.finish();
  const auto fixes = f.all<UltrasonicFix>();
  CHECK(fixes.size() == 100);
  CHECK(f.all<PairHeading>().size() == 100);
  CHECK(f.counters().duplicates == 200);
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    CHECK(seconds_between(fixes[i - 1].emission_time_ns, fixes[i].emission_time_ns) ==
          Approx(0.085).margin(0.003));
    CHECK(fixes[i].quality_percent == 90.0);
  }
}

TEST_CASE("One IMU measurement in two kinds of packet is one sample") {
  Fixture f(TimeMapping::fitted);
  for (std::int64_t i = 0; i < 500; ++i) {
    f.on(imu_at(10 * i), 10 * i + 1);
    f.on(in_real_time(imu_at(10 * i)), 10 * i + 2);
  }
  CHECK(f.all<ImuSample>().size() == 500);
  CHECK(f.counters().duplicates == 500);
}

TEST_CASE("A kind of packet that falls silent gives way to the one that still comes") {
  Fixture f(TimeMapping::fitted);
  for (std::int64_t i = 0; i < 100; ++i) {
    if (i < 50) f.on(in_real_time(imu_at(100 * i)), 100 * i);
    f.on(imu_at(100 * i), 100 * i);
  }
  // 50 of the better kind; the other is let in when a second has passed since.
  CHECK(f.all<ImuSample>().size() == 50 + 50 - 9);
}

TEST_CASE("A position that is sent twice over is one fix") {
  Fixture f;
  f.on(position_at(0), 68);
  f.on(position_at(0), 70);
  f.on(Quality{7, 90, 0}, 71);
  f.finish();
  REQUIRE(f.all<UltrasonicFix>().size() == 1);
  CHECK(f.all<UltrasonicFix>()[0].quality_percent == 90.0);
  CHECK(f.counters().duplicates == 1);
}

TEST_CASE("Values that no beacon can mean are counted and kept back") {
  Fixture f;
  SECTION("a position 20 km away") {
    Position position = position_at(0);
    position.xyz_mm[2] = -20'000'000;
    f.on(position, 68);
    f.finish();
    CHECK(f.events.empty());
  }
  SECTION("an angle of more than a turn: the fix stands, the heading does not") {
    Position position = position_at(0);
    position.angle.word = 3601;
    f.on(position, 68);
    f.finish();
    CHECK(f.all<UltrasonicFix>().size() == 1);
    CHECK_FALSE(f.all<PairHeading>().at(0).valid);
  }
  SECTION("a quality of more than 100 %: the fix stands without") {
    f.on(position_at(0), 68);
    f.on(Quality{7, 101, 0}, 69);
    REQUIRE(f.all<UltrasonicFix>().size() == 1);
    CHECK_FALSE(f.all<UltrasonicFix>()[0].quality_percent);
  }
  SECTION("a unix time before 1970 or beyond what ns can hold") {
    RawImu imu = imu_at(0);
    imu.time = {TimeBase::unix_ms, GENERATE(std::int64_t{-1}, INT64_MAX, INT64_MIN)};
    f.on(imu, 0);
    CHECK(f.events.empty());
  }
  CHECK(f.assembler.beacon(7)->status().samples_rejected == 1);
}

TEST_CASE("A fitted clock holds packets until it has settled, and loses none") {
  Fixture f(TimeMapping::fitted);
  f.on(imu_at(0), 30);  // late: the clock should not believe it
  for (std::int64_t i = 1; i < 25; ++i) f.on(imu_at(10 * i), std::max<std::int64_t>(30, 10 * i + 1));
  CHECK(f.events.empty());
  CHECK(f.assembler.next_deadline_ns() == start_ns + 280 * ms);
  f.flush(279);
  CHECK(f.events.empty());
  f.flush(280);
  const auto samples = f.all<ImuSample>();
  REQUIRE(samples.size() == 25);
  CHECK(samples.front().sensor_time_ns == start_ns + 1 * ms);
  CHECK(samples.back().sensor_time_ns == start_ns + 241 * ms);
}

TEST_CASE("A restarted beacon is counted, and its samples stand in the host's time again") {
  Fixture f(TimeMapping::fitted);
  for (std::int64_t i = 0; i < 1000; ++i) f.on(imu_at(10 * i), 10 * i);
  for (std::int64_t i = 0; i < 100; ++i) f.on(imu_at(10 * i - 900), 15'000 + 10 * i);
  f.finish();
  const auto samples = f.all<ImuSample>();
  REQUIRE(samples.size() == 1100);
  CHECK(samples.back().sensor_time_ns == start_ns + 15'990 * ms);
  CHECK(f.assembler.beacon(7)->status().clock_resets == 1);
}

TEST_CASE(
    "What a beacon sent just before its restart, while the clock still listened, is not mapped by the new "
    "run") {
  Fixture f(TimeMapping::fitted);
  for (std::int64_t i = 0; i < 10; ++i) f.on(imu_at(3'600'000 + 10 * i), 10 * i);
  for (std::int64_t i = 0; i < 100; ++i) f.on(imu_at(10 * i), 200 + 10 * i);
  f.finish();
  const auto samples = f.all<ImuSample>();
  REQUIRE(samples.size() == 100);
  CHECK(samples.front().sensor_time_ns == start_ns + 200 * ms);
  CHECK(f.counters().samples_rejected == 10);
}

TEST_CASE("A time passed of a minute does not send the clock ahead of itself") {
  Fixture f(TimeMapping::fitted);
  for (std::int64_t i = 0; i < 1000; ++i) {
    f.on(imu_at(10 * i), 10 * i);
    if (i == 500) f.on(position_at(4930, 60'000), 5000);
  }
  CHECK(f.assembler.beacon(7)->status().clock_resets == 0);
  CHECK(f.all<ImuSample>().size() == 1000);
}

TEST_CASE("Fixes without a time passed do not pull the clock away from the IMU's") {
  Fixture f(TimeMapping::fitted);
  for (std::int64_t i = 0; i < 1000; ++i) {
    f.on(imu_at(10 * i), 10 * i);
    if (i % 10 == 0) f.on(position_at(10 * i - 30, 0), 10 * i);  // 30 ms old, not the typical 68
  }
  f.finish();
  CHECK(f.all<ImuSample>().back().sensor_time_ns == start_ns + 9990 * ms);
  CHECK(f.all<UltrasonicFix>().back().emission_time_ns == start_ns + 9870 * ms);
}

TEST_CASE("Each beacon has its own clock and status") {
  Fixture f;
  RawImu other = imu_at(50'000);
  other.address = 9;
  f.on(imu_at(0), 0);
  f.on(other, 5);
  f.on(Telemetry{3870, -71, 9}, 6);
  CHECK(f.assembler.addresses() == std::vector<BeaconAddress>{7, 9});
  CHECK(f.all<ImuSample>().at(1).sensor_time_ns == start_ns + 5 * ms);
  const BeaconStatus status = f.assembler.beacon(9)->status();
  CHECK(status.address == 9);
  CHECK(status.battery_v == Approx(3.87));
  CHECK(status.rssi_dbm == -71.0);
  CHECK_FALSE(f.assembler.beacon(7)->status().battery_v);
  CHECK(f.assembler.beacon(8) == nullptr);
}

TEST_CASE("The arrival of a file's packets follows from their content") {
  Assembler assembler(TimeMapping::fixed);
  const auto arrival_ms = [&assembler](const Packet& packet) {
    return (assembler.replay_arrival_ns(packet, start_ns) - start_ns) / ms;
  };
  CHECK(content_time(imu_at(0)) == ContentTime{{TimeBase::uptime_ms, 1000}, 0});
  CHECK(content_time(position_at(0)) == ContentTime{{TimeBase::uptime_ms, 1000}, 68 * ms});
  CHECK_FALSE(content_time(Quality{}));

  CHECK(arrival_ms(imu_at(0)) == 0);
  CHECK(arrival_ms(imu_at(10)) == 10);
  CHECK(arrival_ms(position_at(-50)) == 18);
  CHECK(arrival_ms(Quality{7, 90, 0}) == 18);
  CHECK(arrival_ms(imu_at(15)) == 18);  // never back
  CHECK(arrival_ms(imu_at(20)) == 20);
}
