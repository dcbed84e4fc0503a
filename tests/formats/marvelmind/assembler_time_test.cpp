// Packets to samples: mixed packet kinds, clocks, several beacons.

#include "marvelmind/assembler_fixture.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

namespace assembler_time_test {

using namespace sonopose;
using namespace sonopose::marvelmind;
using namespace sonopose::marvelmind::testing;

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
  // 50 of the preferred kind; the other is accepted one second after the last of them.
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

TEST_CASE("A fitted clock holds packets until it has settled, and loses none") {
  Fixture f(TimeMapping::fitted);
  f.on(imu_at(0), 30);  // late, so the clock should distrust it
  for (std::int64_t i = 1; i < 25; ++i) f.on(imu_at(10 * i), std::max<std::int64_t>(30, 10 * i + 1));
  CHECK(f.events.empty());
  // A quarter of a second after the first packet without the delay of those before.
  CHECK(f.assembler.next_deadline_ns() == start_ns + 281 * ms);
  f.flush(280);
  CHECK(f.events.empty());
  f.flush(281);
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
    if (i % 10 == 0) f.on(position_at(10 * i - 30, 0), 10 * i);  // 30 ms old instead of the typical 68
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
  CHECK(arrival_ms(imu_at(15)) == 18);  // never backwards
  CHECK(arrival_ms(imu_at(20)) == 20);
}

}  // namespace assembler_time_test
