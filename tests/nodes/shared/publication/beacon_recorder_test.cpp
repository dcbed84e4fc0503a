#include "publication/beacon_recorder.hpp"

#include "files/error.hpp"
#include "recording/log_folder.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace beacon_recorder_test {

using namespace sonopose;
using namespace sonopose::publication;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

ImuSample imu_of(BeaconAddress address, TimeNs time_ns) {
  ImuSample imu;
  imu.address = address;
  imu.sensor_time_ns = time_ns;
  imu.angular_velocity_body_radps = {0.1, 0.2, 0.3};
  imu.specific_force_body_mps2 = {0.0, 0.0, 9.81};
  return imu;
}

std::vector<Event> numbered(std::vector<Event> events) {
  std::uint64_t number = 0;
  for (Event& event : events) std::visit([&number](auto& sample) { sample.sequence = ++number; }, event);
  return events;
}

SCENARIO("each beacon has its own log") {
  const TemporaryFolder folder;
  const recording::LogSettings settings{{"source", "serial"}};
  GIVEN("a recorder with interleaved samples of beacons 12 and 7") {
    BeaconRecorder recorder(folder / "log", settings);
    recorder.write(imu_of(12, 1000));
    recorder.write(imu_of(7, 1500));
    recorder.write(imu_of(12, 2000));
    recorder.write(TruthSample{.address = 7, .time_ns = 1500});
    WHEN("it is finished") {
      recorder.finish();
      THEN("each reads back in a folder that names beacon and source") {
        CHECK(recording::read_sensor_log(folder / "log/beacon_12").events ==
              numbered({imu_of(12, 1000), imu_of(12, 2000)}));
        const auto log = recording::read_sensor_log(folder / "log/beacon_7");
        CHECK(log.events == numbered({imu_of(7, 1500)}));
        CHECK(log.truth.size() == 1);
        CHECK(recording::read_log_meta(folder / "log/beacon_7").settings == settings);
        CHECK_FALSE(exists(folder / "log.part"));
      }
      THEN("a reader of the folder is told where the logs are") {
        CHECK_THROWS_WITH(recording::read_sensor_log(folder / "log"),
                          Catch::Contains("has the logs of several beacons: beacon_12, beacon_7"));
      }
    }
    WHEN("it is not finished") {
      recorder.flush();
      THEN("the logs can be read, in a folder with another name") {
        CHECK(recording::read_sensor_log(folder / "log.part/beacon_12").events.size() == 2);
        CHECK_FALSE(exists(folder / "log"));
      }
    }
  }
  GIVEN("a recorder with samples of one beacon") {
    BeaconRecorder recorder(folder / "log");
    recorder.write(imu_of(12, 1000));
    recorder.finish();
    THEN("the folder itself is its log") {
      CHECK(recording::read_sensor_log(folder / "log").events == numbered({imu_of(12, 1000)}));
    }
  }
}

SCENARIO("a recording without a beacon leaves no folder") {
  const TemporaryFolder folder;
  const bool is_finished = GENERATE(true, false);
  {
    BeaconRecorder recorder(folder / "log");
    CHECK(std::filesystem::exists(recorder.part()));
    CHECK(recorder.is_empty());
    if (is_finished) recorder.finish();
  }
  CHECK(std::filesystem::is_empty(folder.path()));
}

SCENARIO("a recording is never overwritten") {
  GIVEN("a folder with a recording") {
    const TemporaryFolder folder;
    write_text(folder / "imu.csv", "precious\n");
    THEN("a recorder refuses it at once") {
      CHECK_THROWS_AS(BeaconRecorder(folder.path()), files::IoError);
      CHECK(sonopose::test::read_text(folder / "imu.csv") == "precious\n");
    }
  }
}

}  // namespace beacon_recorder_test
