#include "recording/tables.hpp"

#include "csv/missing_columns.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <variant>

namespace tables_test {

using namespace sonopose;
using namespace sonopose::recording;
using namespace sonopose::test;
using Catch::Contains;
using Catch::EndsWith;

const std::string imu_rows = "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1000000000,0,0,0,0,0,9.8\n";
const std::string position_rows = "timestamp,x,y,z\n1000000000,1,2,3\n";

SCENARIO("tables of other programs become a log") {
  const TemporaryFolder folder;
  csv::ColumnNames names;
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

SCENARIO("Titles and comments above the names of the columns are no names") {
  const TemporaryFolder folder;
  csv::ColumnNames names;
  GIVEN("titles, comments, and names in a comment of MATLAB") {
    write_text(folder / "imu.csv", "Robot 7\n\nHall 3; Device;7\n" + imu_rows);
    write_text(folder / "positions.csv", "% exported\n% time x y z\n% s m m m\n1.5 1 2 3\n% end\n");
    const Tables tables = read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7);
    THEN("the rows are read, and the titles counted") {
      CHECK(tables.log.events.size() == 2);
      REQUIRE(tables.log.warnings.size() == 1);
      CHECK_THAT(tables.log.warnings.front(), Contains("imu.csv: not read: 2 lines above the names"));
    }
  }
  GIVEN("lines of a key and its value") {
    const std::string value =
        GENERATE("Start: 2026-01-31 12:00:00", "Rate: 100 Hz", "Sensor offset: 0, 0, 0");
    write_text(folder / "imu.csv", "Device: X\n" + value + "\nRange: 16 g\n" + imu_rows);
    write_text(folder / "positions.csv", "Tag: 7\n" + value + "\ntime,x,y,z\n1.5,1,2,3\n");
    const Tables tables = read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7);
    THEN("the rows below them are read") {
      CHECK(tables.log.events.size() == 2);
    }
  }
  GIVEN("rows that begin with an address and are wider than the names") {
    write_text(folder / "imu.csv", imu_rows);
    write_text(folder / "positions.csv", "tag,time,x,y,z\nDE:CA:11,1.5,1,2,3,\nDE:CA:11,1.6,1,2,3,\n");
    const Tables tables = read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7);
    THEN("they are rows") {
      CHECK(tables.log.events.size() == 3);
    }
  }
  GIVEN("a comment above the names, and a first row of words") {
    write_text(folder / "imu.csv", "# exported\n" + imu_rows);
    write_text(folder / "positions.csv",
               "x,y,z,status,text,timestamp\n,,,no,fix,\n1,2,3,ok,fix,1000000000\n");
    THEN("nothing is taken for a title") {
      const Tables tables = read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7);
      CHECK(tables.log.events.size() == 2);
      CHECK(names.titles_by_file.empty());
    }
  }
  GIVEN("names of which one is missing, above rows that begin with a date and end with a separator") {
    write_text(folder / "imu.csv", imu_rows);
    write_text(folder / "positions.csv", "stamp,east,side\n2026-01-31 12:00:00,1,2,\n");
    THEN("the line of the names is blamed") {
      CHECK_THROWS_WITH(read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7),
                        Contains("positions.csv:1: "));
    }
  }
}

/// The first IMU sample and fix of tables with these headers and rows.
std::pair<ImuSample, UltrasonicFix> first_of(const std::string& imu, const std::string& positions,
                                             csv::ColumnNames names = {}) {
  const TemporaryFolder folder;
  write_text(folder / "imu.csv", imu);
  write_text(folder / "positions.csv", positions);
  const Tables tables = read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7);
  std::pair<ImuSample, UltrasonicFix> first;
  for (const Event& event : tables.log.events) {
    if (const auto* imu_sample = std::get_if<ImuSample>(&event)) first.first = *imu_sample;
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) first.second = *fix;
  }
  return first;
}

SCENARIO("headers of common tools need no names") {
  const Vector3d w_radps(0.1, 0.2, 0.3);
  const Vector3d a_mps2(1.0, 2.0, 9.0);
  const Vector3d p_m(4.0, 5.0, 6.0);
  std::string imu = "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n2000000000,.1,.2,.3,1,2,9\n";
  std::string positions = "timestamp,x,y,z\n2000000000,4,5,6\n";
  GIVEN("rostopic echo -p: the stamp of the message counts, not its time in the bag") {
    imu =
        "%time,field.header.seq,field.header.stamp,field.orientation.x,field.angular_velocity.x,"
        "field.angular_velocity.y,field.angular_velocity.z,field.linear_acceleration.x,"
        "field.linear_acceleration.y,field.linear_acceleration.z\n2100000000,1,2000000000,0,.1,.2,.3,1,2,9\n";
    positions =
        "%time,field.header.stamp,field.pose.pose.position.x,field.pose.pose.position.y,"
        "field.pose.pose.position.z,field.pose.pose.orientation.x\n2100000000,2000000000,4,5,6,0\n";
  }
  GIVEN("a bag in a table: the two columns of the message's stamp count, not its time in the bag") {
    imu =
        "Time,header.stamp.secs,header.stamp.nsecs,angular_velocity.x,angular_velocity.y,angular_velocity.z,"
        "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z\n2.1,2,0,.1,.2,.3,1,2,9\n";
    positions = "%time,field.x,field.y,field.z\n2000000000,4,5,6\n";
  }
  GIVEN("arrays with units, and directions") {
    imu =
        "timestamp_us,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],accelerometer_m_s2[1],"
        "accelerometer_m_s2[2]\n2000000,.1,.2,.3,1,2,9\n";
    positions = "sec,NORTH,East,up\n2,5,4,6\n";
  }
  GIVEN("the axis first, milli-g, and German words") {
    imu =
        "Zeit (s);xgyro [rad/s];ygyro [rad/s];zgyro [rad/s];Beschleunigung x [mg];Beschleunigung y [mg];"
        "Beschleunigung z [mg]\n2,0;,1;,2;,3;101,971621;203,943243;917,744593\n";
    positions = "seconds,x mm,y mm,z mm\n2,4000,5000,6000\n";
  }
  const auto [sample, fix] = first_of(imu, positions);
  CHECK(sample.sensor_time_ns == 2'000'000'000);
  CHECK(sample.angular_velocity_body_radps.isApprox(w_radps));
  CHECK(sample.specific_force_body_mps2.isApprox(a_mps2, 1e-6));
  CHECK(fix.emission_time_ns == 2'000'000'000);
  CHECK(fix.position_world_m.isApprox(p_m));
}

SCENARIO("units may be in the line below the names, and times may be dates") {
  const auto [sample, fix] = first_of(
      "time,w_x,w_y,w_z,a_x,a_y,a_z\n,deg/s,deg/s,deg/s,[g],[g],[g]\n"
      "2026-11-27T10:15:30.25Z,90,0,0,0,0,1\n",
      "time,x,y,z\n2026-11-27 11:15:30.300+01:00,4,5,6\n");
  CHECK(sample.angular_velocity_body_radps.x() == Approx(1.5707963));
  CHECK(sample.specific_force_body_mps2.z() == Approx(standard_gravity_mps2));
  CHECK(sample.sensor_time_ns == 1'795'774'530'250'000'000);
  CHECK(fix.emission_time_ns - sample.sensor_time_ns == 50'000'000);
}

SCENARIO("a time in two columns has whole seconds and nanoseconds") {
  const std::string imu = "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1700000000000000001,0,0,0,0,0,9.8\n";
  const auto time_ns = [&](const std::string& seconds, const std::string& nanoseconds) {
    const std::string positions =
        "/pos/header/stamp/sec,/pos/header/stamp/nanosec,x,y,z\n" + seconds + "," + nanoseconds + ",4,5,6\n";
    return first_of(imu, positions).second.emission_time_ns;
  };
  CHECK(time_ns("1700000000", "123456789") == 1'700'000'000'123'456'789);
  const std::string bare = "sec,nanosec,x,y,z\n1700000000,7,4,5,6\n";
  CHECK(first_of(imu, bare).second.emission_time_ns == 1'700'000'000'000'000'007);
  csv::ColumnNames names;
  names.own_by_given = {{"received_at", "timestamp [s]"}};
  const std::string given = "stamp.sec,stamp.nanosec,x,y,z,received_at\n1700000000,5,4,5,6,1700000001\n";
  CHECK(first_of(imu, given, names).second.emission_time_ns == 1'700'000'001'000'000'000);
  CHECK_THROWS_WITH(time_ns("1700000000", "1000000000"), Contains("no nanoseconds in 0 … 999999999"));
  CHECK_THROWS_WITH(time_ns("1700000000", ""), Contains("no nanoseconds in 0 … 999999999"));
}

SCENARIO("positions of several tags are those of one, and may lack a height") {
  const TemporaryFolder folder;
  write_text(folder / "positions.csv", "t,Tag ID,x,y\n1.5,12,1,2\n1.6,7,3,4\n1.7,12,5,6\n");
  csv::ColumnNames names;
  const TableFiles files{folder / "imu.csv", folder / "positions.csv", {}};
  write_text(folder / "imu.csv",
             "t,w_x,w_y,w_z,a_x,a_y,a_z\n1.5,0,0,0,0,0,9.8\n1.7,nan,nan,nan,nan,nan,nan\n");
  WHEN("the table has the beacon") {
    const Tables tables = read_tables(files, names, 12);
    THEN("its rows are the fixes, at height 0, and the others are counted") {
      REQUIRE(tables.log.events.size() == 3);
      CHECK(std::get<UltrasonicFix>(tables.log.events[1]).position_world_m == Vector3d(1.0, 2.0, 0.0));
      CHECK(std::get<UltrasonicFix>(tables.log.events[2]).position_world_m == Vector3d(5.0, 6.0, 0.0));
      CHECK(tables.rows_of_other_tags == 1);
      CHECK_FALSE(tables.has_height);
      CHECK(tables.rows_without_imu == 1);
    }
  }
  WHEN("it has one, which some rows leave empty") {
    write_text(folder / "positions.csv", "t,Tag ID,x,y\n1.5,12,1,2\n1.6,,3,4\n");
    THEN("all rows are its fixes") {
      CHECK(read_tables(files, names, 7).log.events.size() == 3);
    }
  }
  WHEN("it does not have the beacon") {
    THEN("the tags are named") {
      CHECK_THROWS_WITH(read_tables(files, names, 8),
                        Contains("positions.csv: has rows of the devices 12, 7; choose one with --tag"));
    }
    THEN("a choice of another one is refused, also if there is a single one or no such column") {
      TableFiles chosen = files;
      chosen.tag = "9";
      CHECK_THROWS_WITH(read_tables(chosen, names, 7),
                        Contains("has rows of the devices 12, 7, and none of the device \"9\""));
      write_text(folder / "positions.csv", "t,Tag ID,x,y\n1.5,12,1,2\n");
      CHECK_THROWS_WITH(read_tables(chosen, names, 7), Contains("none of the device \"9\""));
      write_text(folder / "positions.csv", "t,x,y\n1.5,1,2\n");
      CHECK_THROWS_WITH(read_tables(chosen, names, 7), Contains("no table has a column that names devices"));
    }
  }
  WHEN("the IMU's table has several devices too") {
    write_text(folder / "imu.csv",
               "t,device_id,w_x,w_y,w_z,a_x,a_y,a_z\n1.5,A4:CF,0,0,0,0,0,9.8\n1.6,B0:11,0,0,0,0,0,9.7\n");
    write_text(folder / "positions.csv", "t,Tag ID,x,y\n1.5,A4:CF,1,2\n1.6,B0:11,3,4\n1.7,B0:11,5,6\n");
    THEN("they are named") {
      CHECK_THROWS_WITH(read_tables(files, names, 7),
                        Contains("imu.csv: has rows of the devices A4:CF, B0:11; choose one with --tag"));
    }
    THEN("a choice holds for both") {
      TableFiles chosen = files;
      chosen.tag = "A4:CF";
      const Tables tables = read_tables(chosen, names, 7);
      CHECK(tables.log.events.size() == 2);
      CHECK(tables.rows_of_other_tags == 3);
    }
  }
  WHEN("a column of ids numbers the rows") {
    std::string rows = "t,id,x,y\n";
    for (int i = 0; i < 100; ++i) rows += "1." + std::to_string(100 + i) + "," + std::to_string(i) + ",1,2\n";
    write_text(folder / "positions.csv", rows);
    THEN("all are read") {
      CHECK(read_tables(files, names, 7).log.events.size() == 101);
    }
  }
}

SCENARIO("a table without the names of its columns is refused as such") {
  CHECK_THROWS_WITH(
      first_of("timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9.8\n", "1700000,12,7,0.3,0.4,1.2\n"),
      Contains("positions.csv:1: the header has no column \"timestamp [ns]\"") && !Contains("tag") &&
          EndsWith(": numbers instead of names"));
}

SCENARIO("a line that is too long ends the search for the header") {
  CHECK_THROWS_WITH(first_of(imu_rows, "# comment\n#" + std::string(400'000, '1') + "\n"),
                    Contains("positions.csv:2"));
}

SCENARIO("rows may lack a value, end in a separator, and begin at a whole second") {
  const TemporaryFolder folder;
  write_text(folder / "imu.csv", "t,w_x,w_y,w_z,a_x,a_y,a_z\n0,0,0,0,0,0,9.8,\n0.01,0,0,0,0,0,9.8,\n");
  write_text(folder / "positions.csv", "t,x,y,z\n0,1,2,3\n0.1,nan,nan,nan\n0.2,-,-,-\n0.3,4,5,6\n");
  csv::ColumnNames names;
  const Tables tables = read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7);
  CHECK(tables.log.events.size() == 4);
  CHECK(tables.rows_without_position == 2);
  CHECK(std::get<UltrasonicFix>(tables.log.events.back()).emission_time_ns == 1'300'000'000);
  write_text(folder / "positions.csv", "t,x,y,z\n0,1,2,3,,4\n");
  CHECK_THROWS_WITH(read_tables({folder / "imu.csv", folder / "positions.csv", {}}, names, 7),
                    Contains("positions.csv:2: has 6 columns where the header has 4"));
}

SCENARIO("the positions are moved to the clock of the IMU") {
  const TemporaryFolder folder;
  write_text(folder / "imu.csv", "t,w_x,w_y,w_z,a_x,a_y,a_z\n0,0,0,0,0,0,9.8\n0.01,0,0,0,0,0,9.8\n");
  write_text(folder / "positions.csv", "timestamp,x,y,z\n1700000000005000000,1,2,3\n");
  csv::ColumnNames names;
  TableFiles files{folder / "imu.csv", folder / "positions.csv", {}};
  files.position_shift_ns = -1'700'000'000'000'000'000;
  const Tables tables = read_tables(files, names, 7);
  REQUIRE(tables.log.events.size() == 3);
  const auto& fix = std::get<UltrasonicFix>(tables.log.events[1]);
  CHECK(fix.emission_time_ns - std::get<ImuSample>(tables.log.events[0]).sensor_time_ns == 5'000'000);
}

SCENARIO("of two columns with one meaning a given one counts") {
  const std::string imu =
      "timestamp,w_x,w_y,w_z,acc_x,acc_y,acc_z,accel_x,accel_y,accel_z\n1,0,0,0,1,2,3,4,5,6\n";
  const std::string positions = "timestamp,x,y,z\n1,0,0,0\n";
  CHECK_THROWS_WITH(first_of(imu, positions), Contains("column 8 (accel_x): column 5 (acc_x) is the same"));
  csv::ColumnNames names;
  names.own_by_given = {{"accel_x", "a_x"}, {"accel_y", "a_y"}, {"accel_z", "a_z"}};
  CHECK(first_of(imu, positions, names).first.specific_force_body_mps2 == Vector3d(4.0, 5.0, 6.0));
}

SCENARIO("a part of a name, and a quaternion in an array, are no column") {
  const std::string positions = "timestamp,x,y,z\n1,0,0,0\n";
  const auto missing_in = [&](const std::string& header) {
    try {
      first_of(header + "\n1,0,0,0,0,0,9.8\n", positions);
    } catch (const csv::MissingColumns& error) {
      return error.columns().front().column;
    }
    return std::string();
  };
  CHECK(missing_in("timestamp,bias_gyro_x,w_y,w_z,a_x,a_y,a_z") == "w_x");
  CHECK(missing_in("header.stamp.sec,w_x,w_y,w_z,a_x,a_y,a_z") == "timestamp");
  CHECK(missing_in("timestamp,gyro[0],gyro[1],gyro[2],gyro[3],a_y,a_z") == "w_x");
}

SCENARIO("a column that is missing or given in vain is an error") {
  const TemporaryFolder folder;
  csv::ColumnNames names;
  write_text(folder / "imu.csv", "timestamp,rate1_x,w_y,w_z,a_x,a_y,a_z,note\n1,0,0,0,0,0,9.8,-\n");
  write_text(folder / "positions.csv", "timestamp,x,y,z\n1,0,0,0\n");
  const TableFiles files{folder / "imu.csv", folder / "positions.csv", {}};
  GIVEN("a missing column") {
    THEN("the error names it, and the columns that it could be") {
      try {
        read_tables(files, names, 7);
        FAIL("was read");
      } catch (const csv::MissingColumns& error) {
        CHECK_THAT(error.what(), Contains("imu.csv:1: the header has no column \"w_x [rad s^-1]\""));
        REQUIRE(error.columns().size() == 1);
        CHECK(error.columns()[0].column == "w_x");
        CHECK(error.columns()[0].candidates == std::vector<std::string>{"rate1_x"});
      }
    }
  }
  GIVEN("a table whose time has an own name, beside a temperature") {
    const auto [time, others] =
        GENERATE(std::pair("Zeitstempel", "Temp,Luftdruck"), std::pair("Tick", "Temp,Stop"),
                 std::pair("sample_us", "Temp,w_p"), std::pair("Nr", "Temp"));
    write_text(folder / "imu.csv", std::string(time) + ",w_x,w_y,w_z,a_x,a_y,a_z," + others + "\n");
    THEN("only the time is proposed") {
      try {
        read_tables(files, names, 7);
        FAIL("was read");
      } catch (const csv::MissingColumns& error) {
        CHECK(error.columns()[0].candidates == std::vector<std::string>{time});
      }
    }
  }
  GIVEN("columns that are missing in both tables") {
    write_text(folder / "imu.csv", "timestamp,rate1_x,rate1_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9.8\n");
    write_text(folder / "positions.csv", "moment,x,y,z\n1,0,0,0\n");
    THEN("one error names them all") {
      CHECK_THROWS_WITH(
          read_tables(files, names, 7),
          Contains("imu.csv:1: the header has no column \"w_x [rad s^-1]\", \"w_y [rad s^-1]\": ") &&
              Contains("positions.csv:1: the header has no column \"timestamp [ns]\""));
    }
  }
  GIVEN("a name that no table can have") {
    names.own_by_given = {{"rate1_x", "omga_x"}};
    THEN("it is refused with those that can be given") {
      CHECK_THROWS_WITH(read_tables(files, names, 7),
                        Contains("\"omga_x\" (given for the column \"rate1_x\") is none of the names") &&
                            Contains("w_x [rad s^-1]") && Contains("quality [%]") && Contains("q_w []"));
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

/// Reads tables from texts.
Tables tables_of(const std::string& imu, const std::string& positions, csv::ColumnNames names = {},
                 const std::string& tag = {}) {
  const TemporaryFolder folder;
  write_text(folder / "imu.csv", imu);
  write_text(folder / "positions.csv", positions);
  TableFiles files{folder / "imu.csv", folder / "positions.csv", {}};
  files.tag = tag;
  return read_tables(files, names, 7);
}

SCENARIO("a line of units may be a comment, and have words of other columns") {
  const auto [sample, fix] = first_of(
      "timestamp,w_x,w_y,w_z,a_x,a_y,a_z,temp,seq\nns,deg/s,deg/s,deg/s,g,g,g,°C,count\n"
      "1000000000,90,0,0,0,0,1,25,1\n",
      "#timestamp,x,y,z\n#ns,cm,cm,cm\n1000000000,100,200,300\n");
  CHECK(sample.angular_velocity_body_radps.x() == Approx(1.5707963));
  CHECK(fix.position_world_m.isApprox(Vector3d(1.0, 2.0, 3.0)));
  const auto commented =
      first_of(imu_rows, "timestamp x y z\n# measured in cm\n# cm\n1000000000 100 200 300\n");
  CHECK(commented.second.position_world_m.x() == Approx(100.0));
  CHECK_THROWS_WITH(first_of(imu_rows, "timestamp,x,y,z\nns,m,m,furlong\n1000000000,1,2,3\n"),
                    Contains("the unit \"furlong\" is unknown here"));
}

SCENARIO("rows that lack a value are left out of tables, and counted") {
  GIVEN("cells without a number, and rows that a spreadsheet could not compute") {
    const Tables tables = tables_of(imu_rows +
                                        "1010000000,0,nan,0,0,0,9.8\n#N/A,#N/A,#N/A,#N/A,#N/A,#N/A,#N/A\n"
                                        "# a comment\n1020000000,,,,0,0,9.8\n,0,0,0,0,0,9.8\n",
                                    position_rows + "1010000000,1,,3\n#DIV/0!,1,2,3\n");
    CHECK(tables.log.events.size() == 2);
    CHECK(tables.rows_without_imu == 4);
    CHECK(tables.rows_without_position == 2);
  }
  GIVEN("one table, whose rows have rates or forces") {
    const std::string rows =
        "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1000000000,,,,0,0,9.8\n1010000000,1,2,3,,,\n";
    CHECK_THROWS_WITH(tables_of(rows, position_rows),
                      Contains("imu.csv: has no row with IMU values; 2 have only some"));
  }
  GIVEN("a text among the numbers") {
    CHECK_THROWS_WITH(tables_of(imu_rows + "1010000000,0,none at all,0,0,0,9.8\n", position_rows),
                      Contains("imu.csv:3: column 3 (w_y): \"none at all\" is not a number"));
  }
}

SCENARIO("a choice of a device leaves tables of a single one as they are") {
  const std::string imu = "timestamp,device_id,w_x,w_y,w_z,a_x,a_y,a_z\n1000000000,imu_1,0,0,0,0,0,9.8\n";
  const std::string positions = "timestamp,tag,x,y,z\n1000000000,A,1,2,3\n1000000000,B,4,5,6\n";
  const Tables tables = tables_of(imu, positions, {}, "B");
  REQUIRE(tables.log.events.size() == 2);
  CHECK(std::get<UltrasonicFix>(tables.log.events[1]).position_world_m.x() == 4.0);
  REQUIRE(tables.log.warnings.size() == 1);
  CHECK_THAT(tables.log.warnings.front(), Contains("imu.csv: has rows of the devices imu_1, and none of"));
}

SCENARIO("words that come again in an unknown column may be devices") {
  const auto warnings_of = [](const std::string& one, const std::string& other) {
    return tables_of(imu_rows, "timestamp,name,x,y,z\n1000000000," + one + ",1,2,3\n1000000000," + other +
                                   ",4,5,6\n1010000000," + one + ",1,2,3\n1010000000," + other + ",4,5,6\n")
        .log.warnings;
  };
  REQUIRE(warnings_of("cart", "lift").size() == 1);
  CHECK_THAT(warnings_of("cart", "lift").front(),
             Contains("the column \"name\" names devices (cart, lift)") &&
                 Contains("--column \"tag=name\" --tag cart"));
  CHECK(warnings_of("cart", "cart").empty());
  CHECK(warnings_of("1", "2").empty());
}

SCENARIO("a column's name may hold for one file") {
  const std::string imu = "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1700000000010,0,0,0,0,0,9.8\n";
  const std::string positions = "timestamp,x,y,z\n1700000000053648,1,2,3\n";
  csv::ColumnNames names;
  names.own_by_given = {{"imu.csv:timestamp", "timestamp [ms]"},
                        {"positions.csv:timestamp", "timestamp [us]"}};
  const auto [sample, fix] = first_of(imu, positions, names);
  CHECK(sample.sensor_time_ns == 1'700'000'000'010'000'000);
  CHECK(fix.emission_time_ns == 1'700'000'000'053'648'000);
  names.own_by_given = {{"other.csv:timestamp", "timestamp [ms]"}};
  CHECK_THROWS_WITH(first_of(imu, positions, names),
                    Contains("no table has a column \"other.csv:timestamp\""));
}

SCENARIO("brackets may be notes") {
  const auto x_radps_of = [](const std::string& column, csv::ColumnNames names = {}) {
    return first_of("timestamp," + column + ",w_y,w_z,a_x,a_y,a_z\n1000000000,0.5,0,0,0,0,9.8\n",
                    position_rows, std::move(names))
        .first.angular_velocity_body_radps.x();
  };
  CHECK(x_radps_of("w_x (body) [rad/s]") == 0.5);
  CHECK(x_radps_of("w_x [rad/(s)] (body)") == 0.5);
  CHECK_THROWS_WITH(x_radps_of("w_x (body)"),
                    Contains("the unit \"body\" is unknown here") &&
                        Contains("if it is a note, give the unit: --column \"w_x [rad s^-1]=w_x (body)\""));
  csv::ColumnNames names;
  names.own_by_given = {{"w_x (body)", "w_x [rad s^-1]"}};
  CHECK(x_radps_of("w_x (body)", names) == 0.5);
}

}  // namespace tables_test
