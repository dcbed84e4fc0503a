/// Velocities, headings and poses from ROS 2: messages on the way to samples.

#include "ros2/relay/aiding_inputs.hpp"

#include "bridge/collecting_sink.hpp"
#include "clocks/clocks.hpp"
#include "support/test_domain.hpp"
#include "support/wait_until.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::aiding_inputs_test {

using Catch::Matchers::Contains;
using ros2::AidingInput;
using ros2::InputMonitor;
using Kind = AidingInput::Kind;
using Received = ros2::relay::AidingInputs::Received;

constexpr TimeNs second_ns = 1'000'000'000;

/// Frames without tf: map, base, and a sensor turned left by 90° on the base.
ros2::InputFrames frames(const ros2::Mount& mount) {
  const auto find = [](BeaconAddress, const std::string& frame) -> std::optional<ros2::Transform> {
    if (frame.empty() || frame == "map" || frame == "base_link") return ros2::Transform{};
    if (frame != "sensor") return std::nullopt;
    return ros2::Transform{{0.2, 0, 0}, geometry::rotation_about_z(0.5 * std::numbers::pi)};
  };
  return {.mount = [&mount](BeaconAddress) { return mount; }, .in_map = find, .in_base = find};
}

SCENARIO("velocities of drivers become samples") {
  GIVEN("a driver of odometry, and one of TwistStamped") {
    const test::TestDomain domain;
    const dds::qos::Provider qos;
    const auto participant = dds::ext::participant({.domain_id = domain.id()});
    const auto drivers = dds::ext::participant({.domain_id = domain.id()});
    ros2::Node node(participant, qos, ros2::NameResolver({}), ros2::Distro::jazzy);
    ros2::Mount mount;
    ros2::relay::AidingInputs inputs(node,
                                     {AidingInput::parse(Kind::odometry, "/odom=7"),
                                      AidingInput::parse(Kind::twist, "/wheel:TwistStamped=8")},
                                     frames(mount), second_ns);
    dds::pub::DataWriter<ros2::Odometry> odometry(dds::pub::Publisher(drivers),
                                                  dds::topic::Topic<ros2::Odometry>(drivers, "rt/odom"));
    dds::pub::DataWriter<ros2::TwistStamped> wheel(
        dds::pub::Publisher(drivers), dds::topic::Topic<ros2::TwistStamped>(drivers, "rt/wheel"));
    REQUIRE(test::wait_until([&] {
      return odometry.publication_matched_status().current_count() > 0 &&
             wheel.publication_matched_status().current_count() > 0;
    }));
    test::CollectingSink sink;
    InputMonitor::Lines lines;
    const auto take_until = [&](const auto& condition) {
      return test::wait_until([&] {
        inputs.take(
            sink,
            [](const AidingInput&) {
              return Received{5'000'000'000, 5'000'000'000};
            },
            lines);
        return condition();
      });
    };
    WHEN("they publish") {
      std::string frame = "base_link";
      ros2::Odometry message{};
      message.header.frame_id = frame.data();
      message.child_frame_id = frame.data();
      message.twist.twist.linear.x = 1.5;
      message.header.stamp.sec = 3;
      odometry.write(message);
      ros2::TwistStamped stamped{};
      stamped.header.frame_id = frame.data();
      stamped.twist.linear.x = -0.5;
      wheel.write(stamped);
      THEN("each beacon gets its velocity") {
        REQUIRE(take_until([&] { return sink.of_kind<TwistSample>().size() == 2; }));
        for (const TwistSample& twist : sink.of_kind<TwistSample>()) {
          CHECK(twist.velocity_body_mps.x() == (twist.address == 7 ? 1.5 : -0.5));
        }
        AND_THEN("the ages of the stamps can be compared with those of the IMU") {
          std::vector<double> ages_s;
          inputs.update(clocks::steady_now(), lines,
                        [&ages_s](ros2::MonitoredInput& input) { ages_s.push_back(input.offset.value_s()); });
          CHECK(ages_s == std::vector{2.0, 0.0});  // the second has no stamp
        }
      }
    }
    WHEN("a driver publishes two messages without a measured axis") {
      std::string frame = "base_link";
      ros2::Odometry message{};
      message.header.frame_id = frame.data();
      message.child_frame_id = frame.data();
      message.header.stamp.sec = 3;
      for (const int i : {0, 7, 14}) message.twist.covariance[i] = -1.0;
      odometry.write(message);
      odometry.write(message);
      message.twist.covariance[0] = 0.1;
      odometry.write(message);
      THEN("this is said once") {
        REQUIRE(take_until([&] { return sink.of_kind<TwistSample>().size() == 1; }));
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines.front().text(), Contains("beacon 7: /odom has velocities that are not used"));
      }
    }
    WHEN("a driver publishes a variance that is no number, without a stamp") {
      std::string frame = "base_link";
      ros2::Odometry message{};
      message.header.frame_id = frame.data();
      message.child_frame_id = frame.data();
      message.twist.covariance[0] = 0.01;
      message.twist.covariance[7] = std::numeric_limits<double>::quiet_NaN();
      odometry.write(message);
      THEN("the other axes are used, and both are said") {
        REQUIRE(take_until([&] { return sink.of_kind<TwistSample>().size() == 1; }));
        CHECK((sink.of_kind<TwistSample>().front().axes & twist_velocity_y) == 0);
        REQUIRE(lines.size() == 2);
        CHECK_THAT(lines.front().text(), Contains("a variance is no number: its axis is not measured"));
        CHECK_THAT(lines.back().text(), Contains("/odom has messages without a stamp"));
      }
    }
    WHEN("the mount changes between two messages of a turning base") {
      std::string frame = "base_link";
      ros2::TwistStamped stamped{};
      stamped.header.frame_id = frame.data();
      stamped.twist.angular.z = 2.0;
      wheel.write(stamped);
      REQUIRE(take_until([&] { return sink.of_kind<TwistSample>().size() == 1; }));
      mount.imu_in_base_m = {0.5, 0, 0};
      wheel.write(stamped);
      THEN("the velocity of the IMU is that at its new place") {
        REQUIRE(take_until([&] { return sink.of_kind<TwistSample>().size() == 2; }));
        CHECK(sink.of_kind<TwistSample>().front().velocity_body_mps.y() == 0.0);
        CHECK(sink.of_kind<TwistSample>().back().velocity_body_mps.y() == Approx(1.0));
      }
    }
    WHEN("no valid message has come for long") {
      inputs.update(clocks::steady_now() + 10 * second_ns, lines);
      THEN("each topic is named with the cause") {
        REQUIRE(lines.size() == 2);
        CHECK_THAT(lines.front().text(), Contains("beacon 7: no velocities from ROS 2 yet: /odom has 1 "
                                                  "publisher, but no valid message has arrived"));
      }
    }
    WHEN("publishers of other types and topics are found") {
      std::vector<std::string> logged;
      const auto log = [&logged](logging::Level, const std::string& line) { logged.push_back(line); };
      dds::FoundEndpoint writer;
      for (const char* const topic : {"rt/odom", "rt/odom", "rt/other"}) {
        writer.topic_name = topic;
        writer.type_name = dds::TopicTraits<ros2::TwistStamped>::descriptor().m_typename;
        inputs.check_type(writer, log);
      }
      THEN("that of an input is named once") {
        REQUIRE(logged.size() == 1);
        CHECK(logged.front() ==
              "beacon 7: a publisher of /odom is ignored, because its type is "
              "geometry_msgs/msg/TwistStamped, not nav_msgs/msg/Odometry");
      }
    }
  }
}

/// Inputs with a driver of type T on "/topic".
template <class T>
struct Rig {
  explicit Rig(Kind kind, const std::string& text)
      : inputs(node, {AidingInput::parse(kind, text)}, frames(mount), second_ns),
        driver(drivers, dds::topic::Topic<T>(drivers, "rt/topic")) {
    REQUIRE(test::wait_until([&] { return driver.publication_matched_status().current_count() > 0; }));
  }

  /// Writes messages and takes until `count` are used or refused.
  void pass(const T& message, std::size_t count) {
    driver.write(message);
    REQUIRE(test::wait_until([&] {
      inputs.take(
          sink,
          [](const AidingInput&) {
            return Received{5'000'000'000, 5'000'000'000};
          },
          lines);
      return sink.events.size() + inputs.unused(7) == count;
    }));
  }

  test::TestDomain domain;
  dds::qos::Provider qos;
  dds::domain::DomainParticipant participant = dds::ext::participant({.domain_id = domain.id()});
  dds::domain::DomainParticipant drivers = dds::ext::participant({.domain_id = domain.id()});
  ros2::Node node{participant, qos, ros2::NameResolver({}), ros2::Distro::jazzy};
  ros2::Mount mount;
  ros2::relay::AidingInputs inputs;
  dds::pub::DataWriter<T> driver;
  test::CollectingSink sink;
  InputMonitor::Lines lines;
};

SCENARIO("headings of drivers become samples") {
  std::string frame = "sensor";
  GIVEN("an IMU that is turned left by 90° on the base and points to the map's y") {
    Rig<ros2::Imu> rig(Kind::heading, "/topic=7");
    ros2::Imu message{};
    message.header.frame_id = frame.data();
    message.header.stamp.sec = 5;
    message.orientation = {.x = 0, .y = 0, .z = std::sqrt(0.5), .w = std::sqrt(0.5)};
    message.orientation_covariance[8] = 0.01;
    WHEN("it sends its orientation") {
      rig.pass(message, 1);
      THEN("the body points to x, with the deviation of the message and no mount offset") {
        const auto headings = rig.sink.of_kind<PairHeading>();
        REQUIRE(headings.size() == 1);
        CHECK(headings.front().address == 7);
        CHECK(headings.front().valid);
        CHECK(headings.front().heading_world_rad == Approx(0).margin(1e-9));
        CHECK(headings.front().std_rad == Approx(0.1));
        CHECK(headings.front().flags == heading_flag_of_body);
        CHECK(headings.front().emission_time_ns == 5'000'000'000);
        CHECK(rig.lines.empty());
      }
    }
    WHEN("it says twice that it has none") {
      message.orientation_covariance[0] = -1;
      rig.pass(message, 1);
      rig.pass(message, 2);
      THEN("nothing is used, each message is counted, and the reason is said once") {
        CHECK(rig.sink.events.empty());
        CHECK(rig.inputs.unused(7) == 2);
        REQUIRE(rig.lines.size() == 1);
        CHECK_THAT(rig.lines.front().text(),
                   Contains("beacon 7: /topic has headings that are not used as they are: they have no "
                            "orientation: orientation_covariance[0] is -1"));
      }
    }
    WHEN("its frame is unknown to tf") {
      std::string other = "nowhere";
      message.header.frame_id = other.data();
      rig.pass(message, 1);
      THEN("it is not used, with the frame in the reason") {
        CHECK(rig.inputs.unused(7) == 1);
        CHECK_THAT(rig.lines.front().text(), Contains("'nowhere' with the base"));
      }
    }
    WHEN("the variance of its yaw is negative") {
      message.orientation_covariance[8] = -0.5;
      rig.pass(message, 1);
      THEN("its deviation is unknown, which is said") {
        CHECK(rig.sink.of_kind<PairHeading>().front().std_rad < 0);
        CHECK_THAT(rig.lines.front().text(), Contains("the variance of yaw is not positive"));
      }
    }
  }
  GIVEN("a yaw in degrees") {
    Rig<ros2::Float64> rig(Kind::heading, "/topic:Float64=7");
    rig.pass({.data = -60}, 1);
    THEN("it is counter-clockwise from the map's x") {
      CHECK(rig.sink.of_kind<PairHeading>().front().heading_world_rad == Approx(-std::numbers::pi / 3));
      CHECK(rig.sink.of_kind<PairHeading>().front().std_rad < 0);
    }
  }
}

SCENARIO("poses of drivers become fixes and headings") {
  std::string map = "map";
  GIVEN("odometry of a sensor on the base, with the IMU behind") {
    Rig<ros2::Odometry> rig(Kind::pose, "/topic:Odometry=7");
    rig.mount.imu_in_base_m = {-0.1, 0, 0};
    std::string sensor = "sensor";
    ros2::Odometry message{};
    message.header.frame_id = map.data();
    message.child_frame_id = sensor.data();
    message.pose.pose.position = {.x = 1, .y = 2, .z = 3};
    message.pose.pose.orientation.w = 1;
    for (const int i : {0, 7, 14, 21, 28, 35}) message.pose.covariance[i] = 0.04;
    rig.pass(message, 2);
    THEN("the fix is that of the sensor's place, and the body points right of it") {
      const UltrasonicFix fix = rig.sink.of_kind<UltrasonicFix>().front();
      CHECK(fix.position_world_m == Vector3d(1, 2, 3));
      CHECK(fix.point_body_m.isApprox(Vector3d(0.3, 0, 0)));
      REQUIRE(fix.covariance_world_m2);
      CHECK(fix.covariance_world_m2->std_dev(0) == Approx(0.2));
      const PairHeading heading = rig.sink.of_kind<PairHeading>().front();
      CHECK(heading.heading_world_rad == Approx(-0.5 * std::numbers::pi));
      CHECK(heading.std_rad == Approx(0.2));
    }
  }
  GIVEN("a pose that the user sets in RViz") {
    Rig<ros2::PoseWithCovarianceStamped> rig(Kind::set_pose, "/topic=7");
    ros2::PoseWithCovarianceStamped message{};
    message.header.frame_id = map.data();
    message.header.stamp = {1, 0};
    message.pose.pose.position = {.x = 4, .y = 5, .z = 0};
    message.pose.pose.orientation.w = 1;
    message.pose.covariance[0] = message.pose.covariance[7] = 0.25;
    message.pose.covariance[35] = 0.0685;
    WHEN("it comes") {
      rig.pass(message, 2);
      THEN("the heading comes first, both are marked and of now, and the height is unknown") {
        REQUIRE(rig.sink.events.size() == 2);
        const auto heading = std::get<PairHeading>(rig.sink.events.front());
        const auto fix = std::get<UltrasonicFix>(rig.sink.events.back());
        CHECK(heading.flags == (heading_flag_of_body | heading_flag_set_pose));
        CHECK(heading.std_rad == Approx(std::sqrt(0.0685)));
        CHECK(heading.emission_time_ns < fix.emission_time_ns);
        CHECK((fix.flags & ultrasonic_flag_set_pose) != 0);
        CHECK(fix.emission_time_ns == 5'000'000'000);
        CHECK(fix.covariance_world_m2->std_dev(0) == Approx(0.5));
        CHECK(fix.covariance_world_m2->std_dev(2) >= 50);
        REQUIRE(rig.lines.size() == 1);
        CHECK_THAT(rig.lines.front().text(), Contains("beacon 7: /topic sets the pose to (4.000, 5.000) m"));
      }
    }
    WHEN("its covariance is absurd") {
      message.pose.covariance[0] = -4;
      rig.pass(message, 1);
      THEN("it is refused with the value") {
        CHECK(rig.sink.events.empty());
        CHECK_THAT(rig.lines.front().text(),
                   Contains("the pose of /topic is refused") && Contains("-4") && Contains("negative"));
      }
    }
    WHEN("its position is not finite") {
      message.pose.pose.position.x = std::nan("");
      rig.pass(message, 1);
      THEN("it is refused") {
        CHECK_THAT(rig.lines.front().text(), Contains("refused: a position or stamp is invalid"));
      }
    }
  }
}

SCENARIO("speeds of wheels become velocities") {
  GIVEN("a differential drive, with wheels of 0.1 m and 0.5 m between them") {
    const ros2::Wheels wheels{
        .left_joints = {"left"}, .right_joints = {"right"}, .radius_m = 0.1, .track_m = 0.5};
    std::string left = "left";
    std::string arm = "arm";
    std::string right = "right";
    std::array<char*, 3> names{left.data(), arm.data(), right.data()};
    std::array speeds{10.0, 3.0, 20.0};
    ros2::JointState message{};
    message.name._length = message.velocity._length = 3;
    message.name._buffer = names.data();
    message.velocity._buffer = speeds.data();
    THEN("the base drives at the mean and turns by the difference") {
      const auto twist = ros2::twist_sample(message, wheels, 7, {}, second_ns);
      REQUIRE(twist);
      CHECK(twist->velocity_body_mps.x() == Approx(1.5));
      CHECK(twist->angular_velocity_body_radps.z() == Approx(2.0));
      CHECK((twist->axes & (twist_velocity_x | twist_velocity_y | twist_velocity_z)) == twist_velocity_x);
    }
    THEN("a message without one of the joints is not used") {
      message.name._length = 2;
      CHECK_FALSE(ros2::twist_sample(message, wheels, 7, {}, second_ns));
    }
  }
}

}  // namespace sonopose::aiding_inputs_test
