/// An invalid log is refused with file, line, column and value.

#include "recording/log_folder.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

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

using File = std::string Files::*;
constexpr File imu = &Files::imu;
constexpr File ultrasonic = &Files::ultrasonic;
constexpr File heading = &Files::heading;
constexpr File truth = &Files::truth;

/// A fault of one file, and the error message.
struct Fault {
  File file;
  std::string text;
  std::string message;
  std::string more = {};  ///< another part of the message
};

/// Checks the messages for rows that are added to a valid file, or for files of another content.
void check(bool is_row, const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) {
    CAPTURE(fault.text.substr(0, 200));
    Files files;
    files.*fault.file = is_row ? files.*fault.file + fault.text : fault.text;
    CHECK_THAT(error_message_of(files), Contains(fault.message) && Contains(fault.more));
  }
}

SCENARIO("a valid log is read") {
  CHECK(error_message_of({}) == "no complaint");
}

SCENARIO("an invalid row is reported with file, line, column and value") {
  check(true,
        {{imu, "2,0,0,0,0.5x,0,9.8\n", "/imu.csv:3: column 5 (a_x): \"0.5x\" is not a number"},
         {ultrasonic, "1,2,0,,0,90\n", "/ultrasonic.csv:3: column 4 (y): \"\" is not a number"},
         {imu, "0,0,0,0,0,0,9.8\n",
          "/imu.csv:3: column 1 (timestamp [ns]): \"0\" is not a time between 1 and 2^62"},
         {ultrasonic, "-9223372036854775808,2,0,0,0,90\n",
          "/ultrasonic.csv:3: column 1 (timestamp [ns]): \"-9223372036854775808\" is not a time between"},
         {heading, "1,4611686018427387904,45\n",
          "/heading.csv:3: column 2 (received [ns]): \"4611686018427387904\" is not a time between"},
         {truth, "-1,0,0,0,1,0,0,0\n", "/truth.csv:3: column 1", "\"-1\" is not a time"},
         {imu, "4611686018427387903,0,0,0,0,0,9.8\n", "no complaint"},
         {ultrasonic, "1,2,0,1e999,0,90\n", "ultrasonic.csv:3: column 4 (y): \"1e999\""},
         {heading, "\n1.5,2,45\n", "/heading.csv:4: column 1 (timestamp [ns]): \"1.5\" is not a time"},
         {heading, "1,99999999999999999999,45\n", "heading.csv:3: column 2 (received [ns])"},
         {heading, "1,2,north\n", "column 3 (heading [deg]): \"north\" is not a number"},
         {heading, "1,2,45.000000000000000000000degrees\n", "heading.csv:3: column 3"},
         {truth, "2,0,0,0,1,0,,\n", "/truth.csv:3: column 7 (q_y): \"\" is empty but"},
         {imu, "2,0,0,0\n", "/imu.csv:3: has 4 columns where the header has 7"},
         {heading, "1,2,3,4\n", "/heading.csv:3: has 4 columns where the header has 3"},
         {imu, std::string(1'000'000, '7'), "/imu.csv:3: the line is too long"},
         {imu, std::string("2,0,0,0,0,0,9.8\0,1\n", 19), "/imu.csv:3: has 8 columns"}});
}

SCENARIO("an invalid header, and a row that does not fit it, are reported") {
  std::string wide = Files{}.imu;
  for (int i = 0; i < 60; ++i) wide.insert(wide.find('\n'), ",more");
  const std::string no_time = "the header has no column \"timestamp [ns]\"";
  check(
      false,
      {{ultrasonic, "#timestamp,received,x,y,quality\n",
        "/ultrasonic.csv:1: the header has no column \"z [m]\""},
       {ultrasonic, "#1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30\n",
        no_time},
       {imu, wide, "/imu.csv: the header has 67 columns; at most 64 are read"},
       {imu, "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z,gyro_x\n",
        "/imu.csv:1: column 8 (gyro_x): column 2 (w_x) is the same"},
       {imu, "#timestamp [ns],w_x [deg s^-1],w_y,w_z,a_x,a_y,a_z\n",
        "/imu.csv:1: column 3 (w_y) names no unit, but column 2 (w_x [deg"},
       {ultrasonic, "#timestamp,received,x,y_mm,z\n", "column 3 (x) names no unit, but column 4 (y_mm) does"},
       {imu, "#timestamp [ns],w_x [deg/s],w_y [rad/s],w_z [rad/s],a_x,a_y,a_z\n",
        "/imu.csv:1: column 2 (w_x [deg/s]) has another unit than column 3 (w_y [rad/s])"},
       {imu, "#timestamp [ns],w_x [m s^-2],w_y,w_z,a_x,a_y,a_z\n",
        "/imu.csv:1: column 2 (w_x [m s^-2]): the unit \"m s^-2\"", "expected one of rad s^-1, deg s^-1"},
       {imu, "#timestamp [h],w_x,w_y,w_z,a_x,a_y,a_z\n",
        "column 1 (timestamp [h]): the unit \"h\" is unknown here", "expected one of ns, us, ms, s"},
       {imu, "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z,m_x,m_y\n1,0,0,0,0,0,9.8,1,2\n",
        "/imu.csv:2: has no column \"m_z [uT]\": it is empty but"},
       {imu, "1,0,0,0,0,0,9.8\n", "/imu.csv:1: " + no_time, "1,0,0,0,0,0,9.8"},
       {ultrasonic, "", "/ultrasonic.csv: is empty"},
       {ultrasonic, "#timestamp;received;x;y;z\n1;1;1.234,5;0;0\n",
        "column 3 (x): \"1.234,5\" is not a number"},
       {imu, "#timestamp|w_x|w_y|w_z|a_x|a_y|a_z\n1|0|0|0|0|0|9.8\n", "/imu.csv:1: the header has no column"},
       {truth, "#timestamp [ns] tx ty tz sigma\n1 0 0 0 0 0\n",
        "/truth.csv:2: has 6 columns where the header has 5"}});
}

SCENARIO("text of other systems is read, or refused with a remedy") {
  std::string returns = Files{}.imu;
  std::ranges::replace(returns, '\n', '\r');
  check(false, {{imu, returns, "no complaint"},
                {imu, returns + "2,0,0,0,0,0,up\r", "/imu.csv:3: column 7 (a_z): \"up\" is not a number"},
                {imu, "\xEF\xBB\xBFsep=;\r\ntimestamp [ns];w_x;w_y;w_z;a_x;a_y;a_z\r\n1;0;0;0;0;0;9,8\r\n",
                 "no complaint"},
                {imu, std::string("\xFF\xFEt\0i\0m\0e\0", 10),
                 "/imu.csv: is UTF-16; convert it: iconv -f UTF-16 -t UTF-8"}});
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
