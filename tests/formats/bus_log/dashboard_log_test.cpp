#include "bus_log/sensor_log.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <variant>

namespace dashboard_log_test {

using namespace sonopose;
using Catch::Contains;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

// 2024-03-01 12:00:00 UTC: 1709294400 s.
constexpr TimeNs noon_ns = 1'709'294'400'000'000'000;
constexpr TimeNs ms = 1'000'000;

const std::string imu_line = "T2024_03_01__120000_010,user,41,131,7,0,0,1000,0,0,100,na,na,na\n";
const std::string fix_line = "T2024_03_01__120000_100,user,41,129,7,1.234,-2.000,0.500,2,8192,70\n";
const std::string quality_line = "T2024_03_01__120000_101,user,41,7,7,85,0\n";

SCENARIO("a CSV log of the Dashboard is an input") {
  const TemporaryFolder folder;
  const auto file = folder / "2024__Marvelmind_log.csv";
  GIVEN("an IMU sample, a fix and its quality, and lines of other kinds") {
    write_text(file, imu_line + "T2024_03_01__120000_020,user,41,6,7,3.9,-60\n" + fix_line + quality_line +
                         "T2024_03_01__120000_200,user,42,1,anything\n");
    const auto log = bus_log::read_sensor_log(file);
    THEN("the samples are in SI units, in the clock of the log") {
      REQUIRE(log.events.size() == 3);
      CHECK(log.address == 7);
      CHECK(log.warnings.empty());
      const auto& imu = std::get<ImuSample>(log.events[0]);
      CHECK(imu.sensor_time_ns == noon_ns + 10 * ms);
      CHECK(imu.specific_force_body_mps2.z() == Approx(9.80665));
      CHECK(imu.angular_velocity_body_radps.z() == Approx(100 * 0.0175 * 3.14159265358979 / 180));
      CHECK_FALSE(imu.magnetic_field_body_t.has_value());
      const auto& fix = std::get<UltrasonicFix>(log.events[1]);
      CHECK(fix.position_world_m == Vector3d(1.234, -2.0, 0.5));
      CHECK(fix.emission_time_ns == noon_ns + 30 * ms);
      CHECK(fix.received_time_ns >= noon_ns + 100 * ms);
      CHECK(fix.received_time_ns <= noon_ns + 101 * ms);
      CHECK(fix.quality_percent == 85);
      CHECK_FALSE(std::get<PairHeading>(log.events[2]).valid);  // a single beacon has no direction
    }
  }
  GIVEN("a position that is not available") {
    write_text(file, imu_line + "T2024_03_01__120000_100,user,41,129,7,0,0,0,3,8192,70\n");
    THEN("it is no fix") {
      CHECK(bus_log::read_sensor_log(file).events.size() == 1);
    }
  }
  GIVEN("lines that cannot be read, as the last one of a log that was cut") {
    write_text(file, imu_line + "T2024_03_01__120000_100,user,41,129,7,1.2x,0,0,2,8192,70\n" + imu_line +
                         "T2024_03_01__1200");
    const auto log = bus_log::read_sensor_log(file);
    THEN("they are left out and counted, and the first is named") {
      CHECK(log.events.size() == 2);
      REQUIRE(log.warnings.size() == 1);
      CHECK_THAT(log.warnings[0], Contains("2 lines cannot be read") && Contains("line 2, x, y, z"));
    }
  }
  GIVEN("two beacons") {
    std::string other = imu_line;
    other.replace(other.find(",7,"), 3, ",9,");
    write_text(file, imu_line + other);
    THEN("one is chosen by its address") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("choose one with --beacon: 7, 9"));
      CHECK(bus_log::read_sensor_log(file, BeaconAddress{9}).events.size() == 1);
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file, BeaconAddress{8}),
                        Contains("has no beacon 8; it has 7, 9"));
    }
  }
  GIVEN("another first line") {
    write_text(file, "time,who,what\n" + imu_line);
    const auto log = bus_log::read_sensor_log(file);
    THEN("it is left out and counted") {
      CHECK(log.events.size() == 1);
      CHECK_THAT(log.warnings.at(0), Contains("1 line cannot be read") && Contains("line 1"));
    }
  }
  GIVEN("a day that does not exist") {
    const auto day = GENERATE(as<std::string>(), "2023_02_29", "2024_02_30", "2024_04_31", "2024_12_32");
    std::string line = imu_line;
    write_text(file, line.replace(1, day.size(), day) + imu_line);
    THEN("its line is left out") {
      CHECK(bus_log::read_sensor_log(file).events.size() == 1);
    }
  }
  GIVEN("days at the ends of months") {
    const auto day = GENERATE(as<std::string>(), "2024_02_29", "2023_02_28", "2024_12_31", "2000_02_29");
    std::string line = imu_line;
    write_text(file, line.replace(1, day.size(), day));
    THEN("their lines are read") {
      CHECK(bus_log::read_sensor_log(file).events.size() == 1);
    }
  }
  GIVEN("a text of another kind") {
    write_text(file, "time,x,y\n1,2,3\n");
    THEN("the error names both forms that a file can have") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file),
                        Contains("is not an MCAP file") && Contains("CSV log of the Dashboard"));
    }
  }
  GIVEN("no samples") {
    write_text(file, "T2024_03_01__120000_020,user,41,6,7,3.9,-60\n");
    THEN("the error says so") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("has no position and no IMU sample"));
    }
  }
}

}  // namespace dashboard_log_test
