/// Headings and set poses of ROS 2 reach the fusion through the relay.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <stop_token>
#include <string>
#include <thread>

namespace sonopose::ros2_aiding_test {

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
    Consumer<sonopose_UltrasonicFix> native(bus, topics::fix);
    RosReader<ros2::PoseWithCovarianceStamped> fixes(bus, "/hedge_42/fix");
    const auto fusion = bus.fusion();
    const auto relay =
        bus.ros2({"--imu-in", "/imu=42", "--fix-in", "/tag=42", "--heading-in", "/yaw:Float64=42",
                  "--set-pose-in", "/initialpose=42", "--set-pose-in", "/set_pose:SetPose=42"});
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
      native.take();
      compass.write({.data = 60});
      return faces(60);
    }));
    std::string map = "map";
    ros2::PoseWithCovarianceStamped message{};
    message.header.frame_id = map.data();
    message.pose.pose.position = {.x = 1, .y = 2, .z = 0};
    message.pose.pose.orientation = {.x = 0, .y = 0, .z = std::sqrt(0.5), .w = std::sqrt(0.5)};
    message.pose.covariance[0] = message.pose.covariance[7] = 0.01;
    message.pose.covariance[35] = 0.0025;
    WHEN("the compass falls silent and a client of robot_localization's service sets another yaw") {
      const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
      const auto qos = dds::Qos() << dds::policy::Reliability::Reliable()
                                  << dds::policy::History::KeepLast(10);
      using Service = ros2::SetPose;
      dds::pub::DataWriter<Service::Request> requests(dds::pub::Publisher(participant),
                                                      {participant, "rq/set_poseRequest"}, qos);
      dds::sub::DataReader<Service::Response> replies(dds::sub::Subscriber(participant),
                                                      {participant, "rr/set_poseReply"}, qos);
      REQUIRE(wait_for_status(requests, dds::core::status::StatusMask::publication_matched(),
                              [&] { return requests.publication_matched_status().current_count() > 0; }));
      REQUIRE(wait_for_status(replies, dds::core::status::StatusMask::subscription_matched(),
                              [&] { return replies.subscription_matched_status().current_count() > 0; }));
      requests.write({.header = {.client = 4711, .sequence_number = 3}, .pose = message});
      THEN("it has a reply, and the robot faces there") {
        bool is_answered = false;
        REQUIRE(wait_for_status(replies, dds::core::status::StatusMask::data_available(), [&] {
          dds::ext::take_each(replies, [&](const Service::Response& response, const dds::sub::SampleInfo&) {
            is_answered = response.header.client == 4711 && response.header.sequence_number == 3;
          });
          return is_answered;
        }));
        REQUIRE(poses.wait_until([&] {
          if (!faces(90)) requests.write({.header = {.client = 4711, .sequence_number = 4}, .pose = message});
          return faces(90);
        }));
        CHECK(relay->wait_for_line(Stream::error, "beacon 42: /set_pose sets the pose to (1.000, 2.000) m"));
      }
    }
    WHEN("the compass falls silent and the user sets another yaw") {
      THEN("the robot faces there, at the height that it had, without a reset") {
        REQUIRE(poses.wait_until([&] {
          native.take();
          if (!faces(90)) screen.write(message);  // best effort
          return faces(90);
        }));
        CHECK((poses.samples.back().position_world_m - Vector3d(1, 2, 0.5)).norm() < 0.2);
        CHECK(poses.samples.back().reset_counter == poses.samples.front().reset_counter);
        CHECK(
            relay->wait_for_line(Stream::error, "beacon 42: /initialpose sets the pose to (1.000, 2.000) m"));
        // Each fix of ROS 2 is one of the bus, and arrives once, also that of the set pose.
        native.take();
        const TimeNs set_ns = native.samples.back().emission_time_ns;
        std::map<TimeNs, int> seen;
        REQUIRE(fixes.wait_for([&](const auto& fix) {
          ++seen[stamp_of(fix.header)];
          return stamp_of(fix.header) > set_ns + 500'000'000;
        }));
        native.take();
        for (const auto& [stamp_ns, count] : seen) {
          CHECK(count == 1);
          CHECK(std::ranges::count(native.samples, stamp_ns, &UltrasonicFix::emission_time_ns) == 1);
        }
      }
    }
  }
}

SCENARIO("tags on a robot have the mount of its description") {
  GIVEN("a tag on the base, of a relay that reads the mount from /tf_static") {
    const Bus bus;
    Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
    const auto relay = bus.ros2({"--mount-from-tf", "--imu-in", "/imu=42", "--fix-in", "/tag=42@0,0.4,0.3"});
    const Drivers drivers(bus);
    REQUIRE(relay->wait_for_line(Stream::error, "/tf_static does not have the mount of the IMU on the base"));
    fixes.take();
    CHECK(fixes.samples.empty());
    WHEN("the description of the robot comes, with the IMU 0.2 m above the base and turned by 90°") {
      const std::string base = "base_link";
      const std::string imu = "imu_link";
      const ros2::Transform mount{{0, 0, 0.2}, Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5))};
      const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
      dds::pub::DataWriter<ros2::TFMessage> robot(
          dds::pub::Publisher(participant), dds::topic::Topic<ros2::TFMessage>(participant, "rt/tf_static"),
          qos_of(Subscription::latched));
      auto transform = ros2::transform(mount, clocks::host_now(), base, imu);
      robot.write({{1, 1, &transform, false}});
      THEN("its place is seen from the IMU") {
        REQUIRE(fixes.wait_until([&] { return !fixes.samples.empty(); }));
        CHECK(fixes.samples.front().point_body_m.isApprox(Vector3d(0.4, 0, 0.1), 1e-9));
      }
    }
  }
}

}  // namespace sonopose::ros2_aiding_test
