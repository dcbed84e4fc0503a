/// Logs of an attitude benchmark.

#include "recording/attitude_log.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace attitude_log_test {

using namespace sonopose;
using namespace sonopose::recording;
using Catch::Contains;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

const std::string imu_text =
    "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z,m_x,m_y,m_z\n5,0,0,0,0,0,9.8,20,0,-40\n";

std::string error_message_of(const TemporaryFolder& log) {
  try {
    read_attitude_log(log.path());
  } catch (const files::IoError& error) {
    return error.what();
  }
  return "no complaint";
}

SCENARIO("an attitude log is read, with and without what may be absent") {
  const TemporaryFolder folder;
  write_text(folder / "imu.csv", imu_text);
  GIVEN("the IMU alone") {
    const AttitudeLog log = read_attitude_log(folder.path());
    THEN("there is neither truth nor a movement") {
      CHECK(log.imu.size() == 1);
      CHECK(log.imu[0].magnetic_field_body_t->isApprox(Vector3d(20e-6, 0, -40e-6)));
      CHECK(log.truth.empty());
      CHECK(log.movements.empty());
    }
  }
  GIVEN("truth without a position, and two movements") {
    write_text(folder / "truth.csv", "#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z\n5,,,,0,1,0,0\n6,,,,,,,\n");
    write_text(folder / "movement.csv", "#start [ns],end [ns]\n5,9\n20,20\n");
    const AttitudeLog log = read_attitude_log(folder.path());
    THEN("truth and movements are read") {
      REQUIRE(log.truth.size() == 2);
      CHECK(log.truth[0].q_body_to_world.x() == 1.0);
      REQUIRE(log.movements.size() == 2);
      CHECK(log.movements[0].contains(5));
      CHECK(log.movements[0].contains(9));
      CHECK_FALSE(log.movements[0].contains(10));
      CHECK(log.movements[1].contains(20));
    }
  }
}

SCENARIO("an invalid attitude log is refused by name") {
  const TemporaryFolder folder;
  GIVEN("no sample") {
    write_text(folder / "imu.csv", imu_text.substr(0, imu_text.find('\n') + 1));
    THEN("the file is named") {
      CHECK_THAT(error_message_of(folder), Contains("imu.csv") && Contains("no sample"));
    }
  }
  GIVEN("movements without one") {
    write_text(folder / "imu.csv", imu_text);
    write_text(folder / "movement.csv", "#start [ns],end [ns]\n");
    THEN("the file is named") {
      CHECK_THAT(error_message_of(folder), Contains("movement.csv") && Contains("no span"));
    }
  }
  GIVEN("a movement that ends before it starts") {
    write_text(folder / "imu.csv", imu_text);
    write_text(folder / "movement.csv", "#start [ns],end [ns]\n5,9\n20,19\n");
    THEN("its line is named") {
      CHECK_THAT(error_message_of(folder),
                 Contains("movement.csv:3") && Contains("19") && Contains("before the start"));
    }
  }
}

}  // namespace attitude_log_test
