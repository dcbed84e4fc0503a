/// Autopilots get the poses of the running system.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <stop_token>
#include <thread>

namespace autopilot_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

const std::string px4_input = "/uav_1/fmu/in/vehicle_visual_odometry";

/// PX4's client and its agent: sends timesync_status ten times a second, `offset_ns` ahead of this host.
class Px4 {
public:
  explicit Px4(const Bus& bus, TimeNs offset_ns = 0)
      : offset_ns_(offset_ns),
        status_(bus, "/uav_1/fmu/out/timesync_status", false),
        odometry(bus, px4_input, Subscription::sensor_data) {}

  void stop_its_clock() { thread_ = {}; }

private:
  void run(const std::stop_token& end) {
    while (!end.stop_requested()) {
      ros2::TimesyncStatus status{};
      status.timestamp = static_cast<std::uint64_t>((clocks::host_now() + offset_ns_) / 1000);
      status.source_protocol = 2;
      status_.write(status);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }

  TimeNs offset_ns_;
  RosWriter<ros2::TimesyncStatus> status_;

public:
  RosReader<ros2::VehicleOdometry> odometry;

private:
  std::jthread thread_{[this](const std::stop_token& end) { run(end); }};
};

bool is_sane(const ros2::VehicleOdometry& message) {
  const double norm =
      std::hypot(std::hypot(message.q[0], message.q[1]), std::hypot(message.q[2], message.q[3]));
  return std::isfinite(message.position[0]) && std::abs(norm - 1) < 1e-5 &&
         message.position_variance[0] > 0 && message.quality >= 1;
}

SCENARIO("PX4 gets the pose of a drone, in its own clock") {
  const Bus bus;
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim", "--scenario", "drone"});
  GIVEN("a relay for the PX4 of a vehicle, and no PX4") {
    RosReader<ros2::VehicleOdometry> odometry(bus, px4_input, Subscription::sensor_data);
    const auto relay = bus.ros2({"--px4", "uav_1"});
    THEN("it sends nothing, and says why") {
      CHECK(relay->wait_for_line(Stream::error, "nothing arrives on /uav_1/fmu/out/timesync_status"));
      REQUIRE(odometry.wait_for_writer());
      odometry.take([](const ros2::VehicleOdometry&) { FAIL_CHECK("a pose was sent"); });
    }
  }
  GIVEN("a relay, and a PX4 whose agent is on this machine") {
    const auto relay = bus.ros2({"--px4", "/uav_1", "--rate", "50"});
    Px4 px4(bus);
    REQUIRE(px4.odometry.wait_for(is_sane));
    CHECK(relay->wait_for_line(Stream::error, "on /uav_1/fmu/in/vehicle_visual_odometry"));
    THEN("its stamps are those of the host, and rise") {
      std::uint64_t last_us = 0;
      int before = 0;
      REQUIRE(px4.odometry.wait_for_count(100, [&](const ros2::VehicleOdometry& message) {
        CHECK(message.timestamp_sample > last_us);
        CHECK(message.timestamp >= message.timestamp_sample);
        CHECK(std::llabs(static_cast<TimeNs>(message.timestamp) * 1000 - clocks::host_now()) <
              60'000'000'000);
        CHECK(int{message.pose_frame} == 2);
        last_us = message.timestamp_sample;
        before = message.reset_counter;
      }));
      AND_WHEN("the engine is started again") {
        REQUIRE(bus.settings({"reset", "--beacon", "7"}).code == 0);
        THEN("the reset counter rises by one") {
          REQUIRE(px4.odometry.wait_for(
              [&](const ros2::VehicleOdometry& message) { return message.reset_counter != before; }));
          int after = 0;
          REQUIRE(px4.odometry.wait_for_count(
              200, [&](const ros2::VehicleOdometry& message) { after = message.reset_counter; }));
          CHECK(after == before + 1);
          AND_WHEN("its clock is lost") {
            px4.stop_its_clock();
            THEN("nothing is sent any more, and the log says so") {
              CHECK(relay->wait_for_line(Stream::error, "not sending poses, because its clock is unknown"));
              int in_transit = 0;  // a relay that goes on sends 50 a second
              while (px4.odometry.wait_for([](const ros2::VehicleOdometry&) { return true; },
                                           std::chrono::milliseconds(500))) {
                REQUIRE(++in_transit < 5);
              }
            }
          }
        }
      }
    }
    WHEN("the fusion ends") {
      CHECK(fusion->end_by(SIGTERM).code == 0);
      THEN("the log says so") {
        CHECK(relay->wait_for_line(Stream::error, "not sending poses of beacon 7: no poses arrive"));
      }
    }
  }
  GIVEN("a relay that does not know the mount, and a PX4") {
    const auto relay = bus.ros2({"--px4", "uav_1", "--mount-from-tf"});
    Px4 px4(bus);
    THEN("nothing is sent, and the log says so") {
      CHECK(relay->wait_for_line(Stream::error,
                                 "not sending poses of beacon 7: the mount of the IMU is unknown"));
      REQUIRE(px4.odometry.wait_for_writer());
      px4.odometry.take([](const ros2::VehicleOdometry&) { FAIL_CHECK("a pose was sent"); });
    }
  }
  GIVEN("a PX4 that does not convert its stamps, and started 1000 s ago") {
    const TimeNs offset_ns = 1000'000'000'000 - clocks::host_now();
    const auto relay = bus.ros2({"--px4", "uav_1", "--north", "90"});
    Px4 px4(bus, offset_ns);
    THEN("the stamps are in its clock, in axes north, east, down") {
      ros2::VehicleOdometry got{};
      REQUIRE(px4.odometry.wait_for([&](const ros2::VehicleOdometry& message) {
        got = message;
        return is_sane(message);
      }));
      const TimeNs there_ns = clocks::host_now() + offset_ns;
      CHECK(std::llabs(static_cast<TimeNs>(got.timestamp_sample) * 1000 - there_ns) < 60'000'000'000);
      CHECK(int{got.pose_frame} == 1);
      CHECK(int{got.velocity_frame} == 1);
    }
  }
}

/// ArduPilot's client and its agent: sends its clock a hundred times a second.
class ArduPilot {
public:
  ArduPilot(const Bus& bus, TimeNs offset_ns)
      : offset_ns_(offset_ns), clock_(bus, "/ap/clock"), tf(bus, "/ap/tf", Subscription::sensor_data) {}

private:
  void run(const std::stop_token& end) {
    while (!end.stop_requested()) {
      clock_.write({ros2::to_ros(clocks::host_now() + offset_ns_)});
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  TimeNs offset_ns_;
  RosWriter<ros2::Clock> clock_;

public:
  RosReader<ros2::TFMessage> tf;

private:
  std::jthread thread_{[this](const std::stop_token& end) { run(end); }};
};

SCENARIO("ArduPilot gets the pose of a drone as a transform, in the time since its start") {
  const Bus bus;
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim", "--scenario", "drone"});
  const auto relay = bus.ros2({"--ardupilot", "/ap"});
  GIVEN("an ArduPilot that started 1000 s ago") {
    const TimeNs offset_ns = 1000'000'000'000 - clocks::host_now();
    ArduPilot ardupilot(bus, offset_ns);
    THEN("it gets the frames that it takes, in its time") {
      TimeNs stamp_ns = 0;
      REQUIRE(ardupilot.tf.wait_for([&](const ros2::TFMessage& message) {
        const ros2::TransformStamped& transform = message.transforms._buffer[0];
        CHECK(std::string(transform.header.frame_id) == "odom");
        CHECK(std::string(transform.child_frame_id) == "base_link");
        CHECK(std::isfinite(transform.transform.translation.x));
        stamp_ns = stamp_of(transform.header);
        return true;
      }));
      CHECK(std::llabs(stamp_ns - (clocks::host_now() + offset_ns)) < 60'000'000'000);
    }
  }
  GIVEN("one whose clock was set") {
    ArduPilot ardupilot(bus, 0);
    THEN("it gets nothing, and the log has the remedy") {
      CHECK(relay->wait_for_line(Stream::error, "BRD_RTC_TYPES"));
      REQUIRE(ardupilot.tf.wait_for_writer());
      ardupilot.tf.take([](const ros2::TFMessage&) { FAIL_CHECK("a transform was sent"); });
    }
  }
}

TEST_CASE("The example of an autopilot prints what PX4 would get") {
  const Bus bus;
  const std::string domain = std::to_string(bus.domain_id());
  const std::filesystem::path programs = std::filesystem::path(SONOPOSE_TEST_ROS2).parent_path();
  Process drone("/bin/sh", {SONOPOSE_SOURCE_DIR "/examples/autopilot/drone.sh", "--domain", domain},
                {{"SONOPOSE_BIN", programs.string()}});
  Process px4(SONOPOSE_TEST_PX4_SIDE, {"30"}, {{"ROS_DOMAIN_ID", domain}});
  REQUIRE(px4.wait_for_exit() == 0);
  CHECK_THAT(px4.text(Stream::output),
             Contains("FRD ") && Contains(" m, quality ") && Contains(" %, resets "));
  CHECK(drone.end_by(SIGTERM).code == 0);
}

}  // namespace autopilot_test
