/// An invalid log is refused with file, line, column and value.

#include "recording/log_folder.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace log_errors_test {

using namespace sonopose;
using namespace sonopose::recording;
using Catch::Contains;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

struct Files {
  std::string imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9.8\n";
  std::string ultrasonic = "#timestamp [ns],received [ns],x,y,z,quality\n1,2,0,0,0,90\n";
  std::string heading = "#timestamp [ns],received [ns],heading [deg]\n1,2,45\n";
  std::string truth = "#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z\n1,0,0,0,1,0,0,0\n";
};

/// Error message when reading a folder with these files.
std::string error_message_of(const Files& files) {
  const TemporaryFolder log;
  write_text(log / "imu.csv", files.imu);
  write_text(log / "ultrasonic.csv", files.ultrasonic);
  write_text(log / "heading.csv", files.heading);
  write_text(log / "truth.csv", files.truth);
  try {
    read_sensor_log(log.path());
  } catch (const files::IoError& error) {
    return error.what();
  }
  return "no complaint";
}

SCENARIO("a valid log is read") {
  CHECK(error_message_of({}) == "no complaint");
}

SCENARIO("an invalid cell is reported with file, line, column and value") {
  Files files;
  WHEN("a number is malformed") {
    files.imu += "2,0,0,0,0.5x,0,9.8\n";
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:3: column 5 (a_x): \"0.5x\" is not a number"));
  }
  WHEN("a required number is missing") {
    files.ultrasonic += "1,2,0,,0,90\n";
    CHECK_THAT(error_message_of(files), Contains("/ultrasonic.csv:3: column 4 (y): \"\" is not a number"));
  }
  WHEN("a time is out of range") {
    files.imu += "0,0,0,0,0,0,9.8\n";
    CHECK_THAT(error_message_of(files),
               Contains("/imu.csv:3: column 1 (timestamp [ns]): \"0\" is not a time between 1 and 2^62"));
    files = {};
    files.ultrasonic += "-9223372036854775808,2,0,0,0,90\n";
    CHECK_THAT(error_message_of(files), Contains("/ultrasonic.csv:3: column 1 (timestamp [ns]): "
                                                 "\"-9223372036854775808\" is not a time between"));
    files = {};
    files.heading += "1,4611686018427387904,45\n";
    CHECK_THAT(error_message_of(files), Contains("/heading.csv:3: column 2 (received [ns]): "
                                                 "\"4611686018427387904\" is not a time between"));
    files = {};
    files.truth += "-1,0,0,0,1,0,0,0\n";
    CHECK_THAT(error_message_of(files),
               Contains("/truth.csv:3: column 1") && Contains("\"-1\" is not a time"));
    files = {};
    files.imu += "4611686018427387903,0,0,0,0,0,9.8\n";
    CHECK(error_message_of(files) == "no complaint");
  }
  WHEN("a number is too large for a double") {
    files.ultrasonic += "1,2,0,1e999,0,90\n";
    CHECK_THAT(error_message_of(files), Contains("ultrasonic.csv:3: column 4 (y): \"1e999\""));
  }
  WHEN("a time is not a whole number") {
    files.heading += "\n1.5,2,45\n";
    CHECK_THAT(error_message_of(files),
               Contains("/heading.csv:4: column 1 (timestamp [ns]): \"1.5\" is not a time"));
  }
  WHEN("a time has more than 64 bits") {
    files.heading += "1,99999999999999999999,45\n";
    CHECK_THAT(error_message_of(files), Contains("heading.csv:3: column 2 (received [ns])"));
  }
  WHEN("a heading is text, also a long one") {
    files.heading += "1,2,north\n";
    CHECK_THAT(error_message_of(files), Contains("column 3 (heading [deg]): \"north\" is not a number"));
    files.heading = "#timestamp [ns],received [ns],heading [deg]\n1,2,45.000000000000000000000degrees\n";
    CHECK_THAT(error_message_of(files), Contains("heading.csv:2: column 3"));
  }
  WHEN("a quaternion is incomplete") {
    files.truth += "2,0,0,0,1,0,,\n";
    CHECK_THAT(error_message_of(files), Contains("/truth.csv:3: column 7 (q_y): \"\" is empty but"));
  }
}

SCENARIO("rows and headers of the wrong width are named") {
  Files files;
  WHEN("a row is too short") {
    files.imu += "2,0,0,0\n";
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:3: has 4 columns where the header has 7"));
  }
  WHEN("a row is too long") {
    files.heading += "1,2,3,4\n";
    CHECK_THAT(error_message_of(files), Contains("/heading.csv:3: has 4 columns where the header has 3"));
  }
  WHEN("the header lacks a required column") {
    files.ultrasonic = "#timestamp,received,x,y,quality\n";
    CHECK_THAT(error_message_of(files), Contains("/ultrasonic.csv:1: the header has no column \"z [m]\""));
    files.ultrasonic = "#1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30\n";
    CHECK_THAT(error_message_of(files), Contains("the header has no column \"timestamp [ns]\""));
  }
  WHEN("the header has more columns than are read") {
    for (int i = 0; i < 60; ++i) files.imu.insert(files.imu.find('\n'), ",more");
    CHECK_THAT(error_message_of(files), Contains("/imu.csv: the header has 67 columns; at most 64 are read"));
  }
  WHEN("the header names a column twice, also by another name") {
    files.imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z,gyro_x\n";
    CHECK_THAT(error_message_of(files),
               Contains("/imu.csv:1: column 8 (gyro_x): column 2 (w_x) is the same"));
  }
  WHEN("only a part of a vector names another unit") {
    files.imu = "#timestamp [ns],w_x [deg s^-1],w_y,w_z,a_x,a_y,a_z\n";
    CHECK_THAT(error_message_of(files),
               Contains("/imu.csv:1: column 3 (w_y) names no unit, but column 2 (w_x [deg"));
    files = {};
    files.ultrasonic = "#timestamp,received,x,y_mm,z\n";
    CHECK_THAT(error_message_of(files), Contains("column 3 (x) names no unit, but column 4 (y_mm) does"));
    files = {};
    files.imu = "#timestamp [ns],w_x [deg/s],w_y [rad/s],w_z [rad/s],a_x,a_y,a_z\n";
    CHECK_THAT(error_message_of(files),
               Contains("/imu.csv:1: column 2 (w_x [deg/s]) has another unit than column 3 (w_y [rad/s])"));
  }
  WHEN("a row has both a decimal comma and a point") {
    files.ultrasonic = "#timestamp;received;x;y;z\n1;1;1.234,5;0;0\n";
    CHECK_THAT(error_message_of(files), Contains("column 3 (x): \"1.234,5\" is not a number"));
  }
  WHEN("cells are separated by an unknown character") {
    files.imu = "#timestamp|w_x|w_y|w_z|a_x|a_y|a_z\n1|0|0|0|0|0|9.8\n";
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:1: the header has no column"));
  }
  WHEN("a row between spaces has a cell more than the header") {
    files.truth = "#timestamp [ns] tx ty tz sigma\n1 0 0 0 0 0\n";
    CHECK_THAT(error_message_of(files), Contains("/truth.csv:2: has 6 columns where the header has 5"));
  }
  WHEN("a unit is that of another quantity, or unknown") {
    files.imu = "#timestamp [ns],w_x [m s^-2],w_y,w_z,a_x,a_y,a_z\n";
    CHECK_THAT(error_message_of(files),
               Contains("/imu.csv:1: column 2 (w_x [m s^-2]): the unit \"m s^-2\"") &&
                   Contains("expected one of rad s^-1, deg s^-1"));
    files.imu = "#timestamp [h],w_x,w_y,w_z,a_x,a_y,a_z\n";
    CHECK_THAT(error_message_of(files),
               Contains("column 1 (timestamp [h]): the unit \"h\" is unknown here") &&
                   Contains("expected one of ns, us, ms, s"));
  }
  WHEN("a magnetometer has two axes") {
    files.imu = "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z,m_x,m_y\n1,0,0,0,0,0,9.8,1,2\n";
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:2: has no column \"m_z [uT]\": it is empty but"));
  }
  WHEN("the header line is missing") {
    files.imu = "1,0,0,0,0,0,9.8\n";
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:1: the header has no column \"timestamp [ns]\"") &&
                                            Contains("1,0,0,0,0,0,9.8"));
  }
  WHEN("a file is empty") {
    files.ultrasonic = "";
    CHECK_THAT(error_message_of(files), Contains("/ultrasonic.csv: is empty"));
  }
}

SCENARIO("missing files are named") {
  const TemporaryFolder log;
  CHECK_THROWS_WITH(read_sensor_log(log / "nowhere"), Contains("nowhere: does not exist"));
  CHECK_THROWS_WITH(read_sensor_log(log.path()), Contains("/imu.csv: does not exist"));
  write_text(log / "imu.csv", Files{}.imu);
  CHECK_THROWS_WITH(read_sensor_log(log.path()), Contains("/ultrasonic.csv: does not exist"));
  std::filesystem::create_directory(log / "ultrasonic.csv");
  CHECK_THROWS_WITH(read_sensor_log(log.path()), Contains("/ultrasonic.csv: is a folder, not a file"));
}

SCENARIO("a binary file is refused") {
  Files files;
  WHEN("a line never ends") {
    files.imu += std::string(1'000'000, '7');
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:3: the line is too long"));
  }
  WHEN("a cell contains a zero byte") {
    files.imu += std::string("2,0,0,0,0,0,9.8\0,1\n", 19);
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:3: has 8 columns"));
  }
}

SCENARIO("text of other systems is read, or refused with a remedy") {
  Files files;
  WHEN("lines end in a carriage return alone") {
    for (char& c : files.imu) c = c == '\n' ? '\r' : c;
    CHECK(error_message_of(files) == "no complaint");
    files.imu += "2,0,0,0,0,0,up\r";
    CHECK_THAT(error_message_of(files), Contains("/imu.csv:3: column 7 (a_z): \"up\" is not a number"));
  }
  WHEN("a first line names the separator, after a byte order mark") {
    files.imu = "\xEF\xBB\xBFsep=;\r\ntimestamp [ns];w_x;w_y;w_z;a_x;a_y;a_z\r\n1;0;0;0;0;0;9,8\r\n";
    CHECK(error_message_of(files) == "no complaint");
  }
  WHEN("it is UTF-16") {
    files.imu = std::string("\xFF\xFEt\0i\0m\0e\0", 10);
    CHECK_THAT(error_message_of(files),
               Contains("/imu.csv: is UTF-16; convert it: iconv -f UTF-16 -t UTF-8"));
  }
}

SCENARIO("lines are complete and counted anywhere in a long file") {
  Files files;
  const std::string row = "2,0.1234567890123456,0,0,0,0,9.8\n";
  constexpr std::size_t rows = 50'000;  // 1.6 MB
  files.imu.clear();
  files.imu += "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
  for (std::size_t i = 0; i < rows; ++i) files.imu += row;
  const TemporaryFolder log;
  write_text(log / "imu.csv", files.imu);
  const auto samples = read_imu_csv(log / "imu.csv", 7);
  REQUIRE(samples.size() == rows);
  for (const auto& sample : samples) REQUIRE(sample.angular_velocity_body_radps.x() == 0.1234567890123456);
  files.imu += "wrong";
  CHECK_THAT(error_message_of(files), Contains("/imu.csv:50002: "));
}

}  // namespace log_errors_test
