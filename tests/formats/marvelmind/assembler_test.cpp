// Packets to samples: units, flags, waiting for the quality, dropped values.

#include "marvelmind/assembler_fixture.hpp"

#include <catch2/catch.hpp>

#include <numbers>

namespace assembler_test {

using namespace sonopose;
using namespace sonopose::marvelmind;
using namespace sonopose::marvelmind::testing;

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
  CHECK(fix.flags ==
        (ultrasonic_flag_user_button_1 | ultrasonic_flag_user_button_2 | ultrasonic_flag_other_hedge |
         ultrasonic_flag_out_of_geofence | ultrasonic_flag_pair_centre));
  CHECK_FALSE(fix.measured_delay_s);
  CHECK_FALSE(f.all<PairHeading>().at(0).valid);
}

TEST_CASE("Positions of old firmware are stamped in 1/64 s") {
  Fixture f;
  Position position = position_at(0, 70);
  position.flags = 0;
  position.time = {TimeBase::uptime_64ths, 640};
  f.on(position, 70);
  position.time.ticks += 8;  // by 125 ms
  f.on(position, 195);
  f.finish();
  const auto fixes = f.all<UltrasonicFix>();
  REQUIRE(fixes.size() == 2);
  CHECK(fixes[1].emission_time_ns - fixes[0].emission_time_ns == 125 * ms);
  CHECK(fixes[0].flags == ultrasonic_flag_second_resolution);
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

  SECTION("which arrives: the fix is emitted with it, followed by the heading") {
    f.on(imu_at(70), 70);
    CHECK(f.all<ImuSample>().size() == 2);  // overtakes the waiting fix
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

TEST_CASE("Impossible values are counted and not published") {
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

TEST_CASE("A beacon that was forgotten starts again") {
  Fixture f;
  f.on(imu_at(0), 0);
  RawImu other = imu_at(0);
  other.address = 8;
  f.on(other, 0);
  f.assembler.forget(7);
  CHECK(f.assembler.beacon(7) == nullptr);
  CHECK(f.assembler.addresses() == std::vector<BeaconAddress>{8});
  f.flush(10'000);
  f.on(imu_at(0), 20'000);
  const auto samples = f.all<ImuSample>();
  REQUIRE(samples.size() == 3);
  CHECK(samples.back().sensor_time_ns == start_ns + 20'000 * ms);  // mapped by a new clock
  CHECK(f.counters().imu_samples == 1);
}

}  // namespace assembler_test
