/// Headings and set poses of ROS 2 reach the fusion through the relay.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <chrono>
#include <cmath>
#include <stop_token>
#include <string>
#include <thread>

namespace ros2_aiding_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

/// Drivers of a robot at rest at (1, 2, 0.5), in real time during their lifetime.
class Drivers {
public:
  explicit Drivers(const Bus& bus) : imu_(bus, "/imu", false), tag_(bus, "/tag") {}

private:
  void drive(const std::stop_token& end) {
    ImuSample level;
    level.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
    auto next = std::chrono::steady_clock::now();
    for (int i = 0; !end.stop_requested(); ++i) {
      const TimeNs now_ns = clocks::host_now();
      imu_.write(ros2::raw_imu(level, now_ns, frames_, {}));
      const Vector3d position_m(1, 2, 0.5 + 0.001 * (i % 3));
      if (i % 10 == 0) tag_.write(ros2::position_as_point(position_m, now_ns, frames_));
      std::this_thread::sleep_until(next += std::chrono::milliseconds(10));
    }
  }

  ros2::FrameNames frames_;
  RosWriter<ros2::Imu> imu_;
  RosWriter<ros2::PointStamped> tag_;
  std::jthread thread_{[this](const std::stop_token& end) { drive(end); }};
};

SCENARIO("headings and set poses of ROS 2 reach the fusion") {
  GIVEN("a robot at rest, whose yaw a compass measures in degrees") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--imu-in", "/imu=42", "--fix-in", "/tag=42", "--heading-in",
                                 "/yaw:Float64=42", "--set-pose-in", "/initialpose=42"});
    const Drivers drivers(bus);
    RosWriter<ros2::Float64> compass(bus, "/yaw");
    RosWriter<ros2::PoseWithCovarianceStamped> screen(bus, "/initialpose");
    REQUIRE(compass.wait_for_reader());
    REQUIRE(screen.wait_for_reader());
    const auto faces = [&poses](double yaw_deg) {
      if (poses.samples.empty()) return false;
      const FusedPose& pose = poses.samples.back();
      const double error_rad = geometry::wrap_angle(geometry::yaw_of(pose.q_body_to_world) -
                                                    yaw_deg * geometry::radians_per_degree);
      return (pose.status & (status_initialising | status_heading_unknown)) == 0 &&
             std::abs(error_rad) < 5 * geometry::radians_per_degree;
    };
    REQUIRE(poses.wait_until([&] {
      compass.write({.data = 60});
      return faces(60);
    }));
    WHEN("the compass falls silent and the user sets another yaw") {
      std::string map = "map";
      ros2::PoseWithCovarianceStamped message{};
      message.header.frame_id = map.data();
      message.pose.pose.position = {.x = 1, .y = 2, .z = 0};
      message.pose.pose.orientation = {.x = 0, .y = 0, .z = std::sqrt(0.5), .w = std::sqrt(0.5)};
      message.pose.covariance[0] = message.pose.covariance[7] = 0.01;
      message.pose.covariance[35] = 0.0025;
      THEN("the robot faces there, at the height that it had, without a reset") {
        REQUIRE(poses.wait_until([&] {
          if (!faces(90)) screen.write(message);  // best effort
          return faces(90);
        }));
        CHECK((poses.samples.back().position_world_m - Vector3d(1, 2, 0.5)).norm() < 0.2);
        CHECK(poses.samples.back().reset_counter == poses.samples.front().reset_counter);
        CHECK(
            relay->wait_for_line(Stream::error, "beacon 42: /initialpose sets the pose to (1.000, 2.000) m"));
      }
    }
  }
}

}  // namespace ros2_aiding_test
