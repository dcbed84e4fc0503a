#include "recording/tables.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace tables_test {

using namespace sonopose;
using namespace sonopose::recording;
using namespace sonopose::test;
using Catch::Contains;

SCENARIO("tables of other programs become a log") {
  const TemporaryFolder folder;
  files::ColumnNames names;
  GIVEN("an IMU with own names and decimal commas, and positions in millimetres, both from second 0") {
    write_text(folder / "imu.csv",
               "Zeit (s);Rate X (deg/s);Rate Y (deg/s);Rate Z (deg/s);Acc X (g);Acc Y (g);Acc Z (g);Temp\n"
               "0,00;0;0;90;0;0;1;20\n"
               "0,01;0;0;-90;0;0;-1,5;20\n");
    write_text(folder / "positions.csv", "t [s],y [mm],x [mm],z [mm]\n0.005,2000,1500,0\n0.006,,,\n");
    names.own_by_given = {{"Zeit (s)", "timestamp [s]"},
                          {"Rate X (deg/s)", "w_x"},  // keeps its unit
                          {"Rate Y (deg/s)", "w_y"},
                          {"Rate Z (deg/s)", "w_z"}};
    const Tables tables = read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 9);
    THEN("the events have SI units and times from 1 s on, in order") {
      REQUIRE(tables.log.events.size() == 3);
      const auto& first = std::get<ImuSample>(tables.log.events[0]);
      const auto& fix = std::get<UltrasonicFix>(tables.log.events[1]);
      const auto& second = std::get<ImuSample>(tables.log.events[2]);
      CHECK(tables.times_moved_ns == 1'000'000'000);
      CHECK(first.sensor_time_ns == 1'000'000'000);
      CHECK(first.address == 9);
      CHECK(first.angular_velocity_body_radps.z() == Approx(1.5707963));
      CHECK(second.sensor_time_ns == 1'010'000'000);
      CHECK(second.specific_force_body_mps2.z() == Approx(-1.5 * standard_gravity_mps2));
      CHECK(fix.position_world_m == Vector3d(1.5, 2.0, 0.0));
      CHECK(fix.emission_time_ns == 1'005'000'000);
      CHECK(fix.received_time_ns == fix.emission_time_ns);
    }
    THEN("what was not used is named") {
      CHECK(tables.rows_without_position == 1);
      REQUIRE(tables.unused_columns.size() == 1);
      CHECK_THAT(tables.unused_columns.front(), Contains("imu.csv: Temp"));
    }
  }
  GIVEN("one table with a position in each row, which changes every second row") {
    write_text(folder / "all.csv",
               "timestamp,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z,x,y,z\n"
               "1000000000,0,0,0,0,0,9.8,1,2,3\n"
               "1010000000,0,0,0,0,0,9.8,1,2,3\n"
               "1020000000,0,0,0,0,0,9.8,1.1,2,3\n");
    const Tables tables = read_tables({folder / "all.csv", folder / "all.csv", {}}, names, 7);
    THEN("a repeated position is no fix, and the times stay") {
      CHECK(tables.log.events.size() == 5);
      CHECK(tables.repeated_positions == 1);
      CHECK(tables.times_moved_ns == 0);
      CHECK(tables.unused_columns.empty());
      CHECK(std::get<ImuSample>(tables.log.events.front()).sensor_time_ns == 1'000'000'000);
    }
  }
}

SCENARIO("a column that is missing or given in vain is an error") {
  const TemporaryFolder folder;
  files::ColumnNames names;
  write_text(folder / "imu.csv", "timestamp,rate1_x,w_y,w_z,a_x,a_y,a_z,note\n1,0,0,0,0,0,9.8,-\n");
  write_text(folder / "positions.csv", "timestamp,x,y,z\n1,0,0,0\n");
  const TableFiles files{folder / "imu.csv", folder / "positions.csv", {}};
  GIVEN("a missing column") {
    THEN("the error names it, and the columns that it could be") {
      try {
        read_tables(files, names, 7);
        FAIL("was read");
      } catch (const files::MissingColumn& error) {
        CHECK_THAT(error.what(), Contains("imu.csv:1: the header has no column \"w_x [rad s^-1]\""));
        CHECK(error.column() == "w_x");
        CHECK(error.candidates() == std::vector<std::string>{"rate1_x"});
      }
    }
  }
  GIVEN("a name with another unit than the header's") {
    write_text(folder / "imu.csv", "timestamp,rate_x [rad/s],w_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9.8\n");
    names.own_by_given = {{"rate_x [rad/s]", "w_x [deg/s]"}};
    THEN("both are named") {
      CHECK_THROWS_WITH(read_tables(files, names, 7),
                        Contains("rad/s") && Contains("given as \"w_x [deg/s]\""));
    }
  }
  GIVEN("tables without a row") {
    THEN("each is refused") {
      write_text(folder / "imu.csv", "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n");
      CHECK_THROWS_WITH(read_tables(files, names, 7), Contains("imu.csv: has no row with IMU values"));
      write_text(folder / "imu.csv", "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9.8\n");
      write_text(folder / "positions.csv", "timestamp,x,y,z\n");
      CHECK_THROWS_WITH(read_tables(files, names, 7), Contains("positions.csv: has no row with a position"));
    }
  }
  GIVEN("a name that no header has") {
    names.own_by_given = {{"rate1_x", "w_x"}, {"rate1_y", "w_y"}};
    THEN("it is named") {
      CHECK_THROWS_WITH(read_tables(files, names, 7), Contains("no table has a column \"rate1_y\""));
    }
  }
}

}  // namespace tables_test
