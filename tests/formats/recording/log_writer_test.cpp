#include "recording/log_writer.hpp"

#include "logging/captured_log.hpp"
#include "recording/log_folder.hpp"
#include "recording/samples_at.hpp"
#include "sim/simulator.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <csignal>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace log_writer_test {

using namespace sonopose;
using namespace sonopose::recording;
using Catch::Contains;
using sonopose::test::fix_at;
using sonopose::test::heading_at;
using sonopose::test::imu_at;
using sonopose::test::read_text;
using sonopose::test::TemporaryFolder;

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

/// Writes a simulated walk and returns the events as a log stores them: without flags.
std::vector<Event> record_walk(const std::filesystem::path& folder, double duration_s) {
  sim::Simulator simulator(sim::find_scenario("walk"), {},
                           {.start_time_ns = start_ns, .duration_s = duration_s});
  SensorLogWriter writer(folder);
  std::vector<Event> events;
  while (auto step = simulator.next()) {
    writer.write(step->event);
    if (step->truth) writer.write(*step->truth);
    if (auto* fix = std::get_if<UltrasonicFix>(&step->event)) fix->flags = 0;
    events.push_back(step->event);
  }
  return events;
}

bool same_bits(const TruthSample& a, const TruthSample& b) {
  return a.time_ns == b.time_ns && a.position_world_m == b.position_world_m &&
         a.q_body_to_world.coeffs() == b.q_body_to_world.coeffs() &&
         a.velocity_world_mps == b.velocity_world_mps;
}

SCENARIO("a log reads back to the same bits and in the same order") {
  GIVEN("a minute of the simulator") {
    const TemporaryFolder folder;
    const auto events = record_walk(folder / "log", 60.0);
    THEN("the log yields the same events, including their numbers") {
      REQUIRE(events.size() > 7000);
      CHECK(read_sensor_log(folder / "log").events == events);
    }
    THEN("and the same truth") {
      const auto truth = read_sensor_log(folder / "log").truth;
      sim::Simulator simulator(sim::find_scenario("walk"), {},
                               {.start_time_ns = start_ns, .duration_s = 60.0});
      std::size_t count = 0;
      while (const auto step = simulator.next()) {
        if (!step->truth) continue;
        REQUIRE(count < truth.size());
        REQUIRE(same_bits(*step->truth, truth[count++]));
      }
      CHECK(count == truth.size());
    }
  }
  GIVEN("velocities, some of unknown deviation or with axes that were not measured") {
    const TemporaryFolder folder;
    std::vector<Event> events;
    {
      recording::SensorLogWriter writer(folder / "log");
      for (std::uint64_t number = 1; number <= 4; ++number) {
        TwistSample twist{.address = 7, .sequence = number};
        twist.emission_time_ns = start_ns + static_cast<TimeNs>(number);
        twist.received_time_ns = twist.emission_time_ns + 10;
        twist.velocity_body_mps.x() = 0.1 * static_cast<double>(number);
        twist.axes = twist_velocity_x;
        if (number > 1) twist.velocity_std_mps.x() = 0.03;
        if (number > 2) twist.axes |= twist_angular_velocity_z;
        if (number > 2) twist.angular_velocity_body_radps.z() = -0.7;
        writer.write(twist);
        events.emplace_back(twist);
      }
    }
    THEN("they read back") {
      CHECK(read_sensor_log(folder / "log").events == events);
    }
  }
  GIVEN("ten thousand headings and magnetic fields with random bits, which the files store in other units") {
    const TemporaryFolder folder;
    sim::Random random(1);
    std::vector<PairHeading> headings;
    std::vector<ImuSample> imu;
    {
      SensorLogWriter writer(folder.path());
      for (TimeNs t = 1; t <= 10'000; ++t) {
        const double heading_rad = (2.0 * random.uniform() - 1.0) * std::numbers::pi;
        headings.push_back(heading_at(t));
        headings.back().heading_world_rad = heading_rad;
        headings.back().valid = true;
        imu.push_back(imu_at(t));
        imu.back().magnetic_field_body_t = 5e-5 * random.normal_vector();
        writer.write(headings.back());
        writer.write(imu.back());
      }
    }
    THEN("not one bit is lost") {
      const auto read_headings = read_heading_csv(folder / "heading.csv", 7);
      CHECK(read_headings == headings);
      CHECK(read_imu_csv(folder / "imu.csv", 7) == imu);
    }
  }
  GIVEN("the extremes of the number range, and unknown values") {
    const TemporaryFolder folder;
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    ImuSample imu = imu_at(1, 3);
    imu.angular_velocity_body_radps = {-0.0, 5e-324, std::numeric_limits<double>::max()};
    imu.specific_force_body_mps2 = {nan, std::numeric_limits<double>::infinity(), 0.1 + 0.2};
    const UltrasonicFix fix = fix_at(2, 3);
    const PairHeading heading = heading_at(2, 3);
    TruthSample truth{.address = 3, .time_ns = 9};
    truth.velocity_world_mps = Vector3d::Constant(nan);
    {
      SensorLogWriter writer(folder.path());
      writer.write(imu);
      writer.write(fix);
      writer.write(heading);
      writer.write(truth);
    }
    THEN("they read back") {
      const SensorLog log = read_sensor_log(folder.path(), 3);
      REQUIRE(log.events.size() == 3);
      const auto& back = std::get<ImuSample>(log.events[0]);
      CHECK(back.sensor_time_ns == 1);
      CHECK(back.angular_velocity_body_radps == imu.angular_velocity_body_radps);
      CHECK(std::signbit(back.angular_velocity_body_radps.x()));
      CHECK(std::isnan(back.specific_force_body_mps2.x()));
      CHECK(back.specific_force_body_mps2.tail<2>() == imu.specific_force_body_mps2.tail<2>());
      CHECK_FALSE(std::get<UltrasonicFix>(log.events[1]).quality_percent.has_value());
      CHECK_FALSE(std::get<PairHeading>(log.events[2]).valid);
      REQUIRE(log.truth.size() == 1);
      CHECK(log.truth[0].position_world_m == Vector3d::Zero());
      CHECK(std::isnan(log.truth[0].velocity_world_mps.x()));
    }
  }
}

SCENARIO("the files look as the format says") {
  const TemporaryFolder folder;
  {
    SensorLogWriter writer(folder.path());
    PairHeading heading = heading_at(2);
    heading.emission_time_ns = 1;
    heading.heading_world_rad = 93.5 * (std::numbers::pi / 180.0);
    heading.valid = true;
    writer.write(heading);
  }
  THEN("a heading is printed with the fewest digits") {
    CHECK(read_text(folder / "heading.csv") == "#timestamp [ns],received [ns],heading [deg]\n1,2,93.5\n");
  }
  THEN("files without rows have their header, and there is no truth where none was given") {
    CHECK(read_text(folder / "imu.csv") ==
          "#timestamp [ns],w_x [rad s^-1],w_y [rad s^-1],w_z [rad s^-1],a_x [m s^-2],a_y [m s^-2],a_z [m "
          "s^-2]\n");
    CHECK(read_text(folder / "ultrasonic.csv") ==
          "#timestamp [ns],received [ns],x [m],y [m],z [m],quality [%]\n");
    CHECK_FALSE(exists(folder / "truth.csv"));
  }
}

SCENARIO("a recording is never overwritten or mixed") {
  const TemporaryFolder folder;
  record_walk(folder / "log", 0.2);
  const std::string before = read_text(folder / "log" / "imu.csv");
  WHEN("a second recording uses the same folder") {
    CHECK_THROWS_WITH(SensorLogWriter(folder / "log"),
                      Contains("/log: already contains a recording (imu.csv), which is not overwritten"));
    THEN("the first is untouched") {
      CHECK(read_text(folder / "log" / "imu.csv") == before);
    }
  }
  WHEN("the folder cannot be created") {
    CHECK_THROWS_WITH(SensorLogWriter(folder / "log" / "imu.csv" / "deeper"), Contains("cannot be created"));
  }
  WHEN("a second beacon is written into it") {
    SensorLogWriter writer(folder / "two");
    writer.write(imu_at(1, 7));
    CHECK_THROWS_WITH(writer.write(imu_at(2, 8)), Contains("beacon 8 needs another folder"));
  }
}

SCENARIO("a magnetometer that appears after the first sample is counted and reported") {
  const TemporaryFolder folder;
  logging::test::CapturedError error;
  {
    SensorLogWriter writer(folder.path());
    ImuSample sample = imu_at(1);
    writer.write(sample);
    sample.magnetic_field_body_t = Vector3d(1e-5, 0, 0);
    writer.write(sample);
  }
  error.restore();
  CHECK_THAT(error.read(), Contains("imu.csv: 1 magnetic field not written"));
}

SCENARIO("samples whose meaning a log does not have are counted and reported") {
  const TemporaryFolder folder;
  logging::test::CapturedError error;
  {
    SensorLogWriter writer(folder.path());
    UltrasonicFix fix;
    fix.emission_time_ns = fix.received_time_ns = 1'000'000'000;
    PairHeading heading;
    heading.emission_time_ns = heading.received_time_ns = 1'000'000'000;
    heading.valid = true;
    writer.write(fix);
    writer.write(heading);
    CHECK(writer.misread() == 0);
    fix.point_body_m = Vector3d(0.0, 0.3, 0.0);
    heading.flags = heading_flag_of_body;
    writer.write(fix);
    writer.write(heading);
    CHECK(writer.misread() == 2);
  }
  error.restore();
  CHECK_THAT(error.read(), Contains("a replay takes 2 samples for those of the beacon and its pair"));
}

SCENARIO("a killed process loses at most its last second, and no line is torn") {
  GIVEN("a process that writes 100 samples a second for 1.5 s and is killed without warning") {
    const TemporaryFolder folder;
    const auto log = folder / "log";
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      SensorLogWriter writer(log);
      for (TimeNs i = 0; i < 150; ++i) {
        writer.write(imu_at(start_ns + i * 10'000'000));
        ::usleep(10'000);
      }
      ::kill(::getpid(), SIGKILL);
      ::_exit(1);  // unreachable
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));
    THEN("all but the last second is there and reads") {
      const auto events = read_sensor_log(log).events;
      CHECK(events.size() >= 50);
      CHECK(read_text(log / "imu.csv").ends_with('\n'));
    }
  }
}

}  // namespace log_writer_test
