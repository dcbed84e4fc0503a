/// Lines about beacon clocks that were set, and about stamps that cannot be used.

#include "bridge/beacon_clock_log.hpp"

#include "marvelmind/assembler_fixture.hpp"

#include <catch2/catch.hpp>

namespace beacon_clock_log_test {

using namespace sonopose;
using namespace sonopose::marvelmind;
using bridge::BeaconClockLog;
using Catch::Contains;
using testing::Fixture;

constexpr std::int64_t now_ms = 1'795'000'000'000;
constexpr std::int64_t hour_ms = 3'600'000;

RawImu imu_of_unix_ms(std::int64_t time_ms) {
  RawImu imu = testing::imu_at(0);
  imu.time = {TimeBase::unix_ms, time_ms};
  return imu;
}

Position position_of_unix_ms(std::int64_t time_ms) {
  Position position = testing::position_at(0);
  position.time = {TimeBase::unix_ms, time_ms};
  return position;
}

/// A beacon that sends an IMU packet each 10 ms for two seconds, and whose clock is set after one second. A
/// position that was measured before comes after that.
void send_with_step(Fixture& line, std::int64_t step_ms) {
  for (std::int64_t ms = 0; ms < 2000; ms += 10) {
    const bool is_set = ms >= 1000;
    line.on(imu_of_unix_ms(now_ms + ms + (is_set ? step_ms : 0)), ms);
    if (ms == 1000) line.on(position_of_unix_ms(now_ms + 940), ms + 8);
  }
}

SCENARIO("a beacon clock that was set is named once, with the size of the step") {
  const auto mapping = GENERATE(TimeMapping::fixed, TimeMapping::fitted);
  Fixture line(mapping);
  BeaconClockLog log(mapping);
  GIVEN("a clock that is set ahead by an hour") {
    send_with_step(line, hour_ms);
    const auto said = log.update(line.assembler);
    THEN("one line says so") {
      REQUIRE(said.size() == 1);
      CHECK_THAT(said.front(), Contains("beacon 7: its clock was set ahead by 60.0 min"));
      CHECK(log.update(line.assembler).empty());
    }
  }
  GIVEN("a clock of 1970 that is set to today") {
    Fixture young(mapping);
    for (std::int64_t ms = 0; ms < 2000; ms += 10) {
      young.on(imu_of_unix_ms(ms < 1000 ? ms : now_ms + ms), ms);
    }
    const auto said = log.update(young.assembler);
    THEN("the line says 56.9 years") {
      REQUIRE(said.size() == 1);
      CHECK_THAT(said.front(), Contains("set ahead by 56.9 years"));
    }
  }
  GIVEN("a clock that is set back by ten seconds") {
    for (std::int64_t ms = 0; ms < 2000; ms += 10) {
      line.on(imu_of_unix_ms(now_ms + ms - (ms < 1000 ? 0 : 10'000)), ms);
    }
    const auto said = log.update(line.assembler);
    THEN("the line says so") {
      REQUIRE(said.size() == 1);
      CHECK_THAT(said.front(), Contains("set back by 10.0 s"));
    }
  }
  GIVEN("a clock that is not set, and a silence of a minute") {
    for (std::int64_t ms = 0; ms < 1000; ms += 10) line.on(imu_of_unix_ms(now_ms + ms), ms);
    for (std::int64_t ms = 60'000; ms < 61'000; ms += 10) line.on(imu_of_unix_ms(now_ms + ms), ms);
    THEN("nothing is said") {
      CHECK(log.update(line.assembler).empty());
    }
  }
}

SCENARIO("stamps of the year 2100 and later are said once, with their number") {
  constexpr std::int64_t year_2106_ms = 4'294'967'000'000;
  Fixture line(TimeMapping::fitted);
  BeaconClockLog log(TimeMapping::fitted);
  for (std::int64_t ms = 0; ms < 100; ms += 10) line.on(imu_of_unix_ms(now_ms + ms), ms);
  CHECK(log.update(line.assembler).empty());
  for (std::int64_t ms = 0; ms < 100; ms += 10) line.on(imu_of_unix_ms(year_2106_ms + ms), ms);
  const auto said = log.update(line.assembler);
  REQUIRE(said.size() == 1);
  CHECK_THAT(said.front(), Contains("10 samples of beacon 7 are stamped in the year 2100 or later"));
  line.on(imu_of_unix_ms(year_2106_ms + 100), 100);
  CHECK(log.update(line.assembler).empty());
}

}  // namespace beacon_clock_log_test
