/// ROS 2 drivers feed the fusion through the relay.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"

#include <atomic>
#include <csignal>
#include <memory>
#include <string>
#include <thread>

namespace ros2_input_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

/// Drivers of a robot at rest at (1, 2, 0.5): 100 Hz and 10 Hz, until destruction.
class Drivers {
public:
  explicit Drivers(const Bus& bus)
      : imu_(bus, "/imu/data", false), position_(bus, "/tag/pose"), thread_([this] { drive(); }) {}
  Drivers(const Drivers&) = delete;
  Drivers& operator=(const Drivers&) = delete;
  Drivers(Drivers&&) = delete;
  Drivers& operator=(Drivers&&) = delete;
  ~Drivers() {
    stop_ = true;
    thread_.join();
  }

private:
  void drive() {
    ImuSample rest;
    rest.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
    const ros2::FrameNames frames;
    for (int i = 0; !stop_; ++i) {
      imu_.write(ros2::raw_imu(rest, clocks::host_now(), frames, {}));
      if (i % 10 == 0) {
        position_.write(
            ros2::position_as_pose({1, 2, 0.5}, ros2::fix_covariance(0.02, 1.0), clocks::host_now(), frames));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  RosWriter<ros2::Imu> imu_;
  RosWriter<ros2::PoseWithCovarianceStamped> position_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

SCENARIO("any IMU and any positioning system with a ROS 2 driver feed the fusion") {
  GIVEN("a fusion, a relay that forwards both as beacon 42, and drivers") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    Consumer<sonopose_BeaconStatus> status(bus, topics::beacon_status, dds::topics::Delivery::live);
    RosReader<ros2::Odometry> odometry(bus, "/hedge_42/odom");
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--imu-in", "/imu/data=42", "--fix-in", "/tag/pose=42"});
    auto drivers = std::make_unique<Drivers>(bus);
    THEN("the pose follows the drivers, natively and in ROS 2, and the bridge status reports them") {
      REQUIRE(poses.wait_for([](const FusedPose& pose) {
        return (pose.status & (status_initialising | status_converging)) == 0;
      }));
      const FusedPose& pose = poses.samples.back();
      CHECK(pose.address == 42);
      CHECK((pose.position_world_m - Vector3d(1, 2, 0.5)).norm() < 0.05);
      REQUIRE(odometry.wait_for_count(1, [&](const auto& message) {
        CHECK((ros2::base_in_map(message).translation_m - Vector3d(1, 2, 0.5)).norm() < 0.05);
      }));
      REQUIRE(status.wait_for(
          [](const BeaconStatus& one) { return one.imu_rate_hz > 20 && one.fix_rate_hz > 2; }));
      CHECK(status.samples.back().samples_rejected == 0);
    }
    WHEN("the drivers stop") {
      REQUIRE(poses.wait_for_count(20));
      drivers.reset();
      THEN("the relay reports which stream is silent, and when it resumes") {
        REQUIRE(relay->wait_for_line(Stream::error, "beacon 42: no IMU samples from ROS 2"));
        REQUIRE(relay->wait_for_line(Stream::error, "beacon 42: no fixes from ROS 2"));
        const Drivers again(bus);
        CHECK(relay->wait_for_line(Stream::error, "beacon 42: IMU samples from ROS 2 again"));
      }
      THEN("it ends on a signal") {
        CHECK(relay->end_by(SIGTERM).code == 0);
      }
    }
  }
  GIVEN("a relay whose input is its own output") {
    const Result result = run(SONOPOSE_TEST_ROS2, {"--imu-in", "/hedge_7/imu/data_raw=7", "--domain", "0"});
    THEN("it reports the loop") {
      CHECK(result.code == 1);
      CHECK(result.error.find("relay's own output") != std::string::npos);
    }
  }
}

}  // namespace ros2_input_test
