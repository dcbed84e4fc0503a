/// The real recordings, where present.

#include "support/recordings.hpp"

#include "recording/log_folder.hpp"
#include "support/events.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace recordings_test {

using namespace sonopose;
using namespace sonopose::recording;

const std::filesystem::path recordings = SONOPOSE_RECORDINGS;

bool recordings_are_here() {
  return test::is_here(test::beacon_recordings());
}

/// Number of lines without the header.
std::size_t rows_in(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  return lines - 1;
}

TEST_CASE("the beacon recordings are read completely and in order") {
  if (!recordings_are_here()) return;
  for (const char* name : {"car", "drone_a", "drone_b"}) {
    const auto folder = recordings / "beacons" / name;
    INFO(folder);
    const SensorLog log = read_sensor_log(folder);
    const auto imu = test::samples_of<ImuSample>(log.events);
    const auto fixes = test::samples_of<UltrasonicFix>(log.events);
    const auto headings = test::samples_of<PairHeading>(log.events);
    CHECK(imu.size() == rows_in(folder / "imu.csv"));
    CHECK(fixes.size() == rows_in(folder / "ultrasonic.csv"));
    CHECK(headings.size() == rows_in(folder / "heading.csv"));
    for (std::size_t i = 1; i < log.events.size(); ++i) {
      REQUIRE(sequence_of(log.events[i]) == i + 1);
      REQUIRE(available_at_ns(log.events[i - 1]) <= available_at_ns(log.events[i]));
    }
    // Each recording starts at rest: the specific force is gravity's reaction, along +z.
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < 100; ++i) sum += imu[i].specific_force_body_mps2;
    CHECK((sum / 100.0).norm() == Approx(9.81).margin(0.1));
    CHECK(sum.z() / 100.0 > 9.7);
    for (const UltrasonicFix& fix : fixes) {
      REQUIRE(*fix.measured_delay_s > 0.03);
      REQUIRE(*fix.measured_delay_s < 0.2);
    }
  }
}

TEST_CASE("the car's first heading and fix are those in the file") {
  if (!recordings_are_here()) return;
  const auto events = read_sensor_log(recordings / "beacons" / "car").events;
  const auto fix = test::samples_of<UltrasonicFix>(events).at(0);
  CHECK(fix.emission_time_ns == 1'700'000'000'591'497'023);
  CHECK(fix.position_world_m == Vector3d(0.085, 0.055, 0));
  CHECK(fix.quality_percent == 90.0);
  CHECK(*fix.measured_delay_s == Approx(0.068));
  CHECK(test::samples_of<PairHeading>(events).at(0).heading_world_rad == Approx(1.63188285));  // 93.5 deg
}

TEST_CASE("the attitude recordings have a magnetometer, and truth without position") {
  if (!recordings_are_here()) return;
  int trials = 0;
  for (const auto& trial : std::filesystem::directory_iterator(recordings / "attitude")) {
    if (!trial.is_directory()) continue;
    ++trials;
    INFO(trial.path());
    const auto imu = read_imu_csv(trial.path() / "imu.csv", 7);
    CHECK(imu.size() == rows_in(trial.path() / "imu.csv"));
    REQUIRE(imu.front().magnetic_field_body_t.has_value());
    const double field_t = imu.front().magnetic_field_body_t->norm();
    CHECK(field_t > 20e-6);  // the Earth's field, indoors
    CHECK(field_t < 80e-6);
    const auto truth = read_truth_csv(trial.path() / "truth.csv", 7);
    CHECK(truth.size() == rows_in(trial.path() / "truth.csv"));
    CHECK(std::isnan(truth.front().position_world_m.x()));
    CHECK(truth.front().q_body_to_world.norm() == Approx(1.0).margin(1e-4));
  }
  CHECK(trials == 10);
}

}  // namespace recordings_test
