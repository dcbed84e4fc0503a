/// Velocities from ROS 2: options, and messages on the way to samples.

#include "ros2/relay/twist_inputs.hpp"

#include "bridge/collecting_sink.hpp"
#include "clocks/clocks.hpp"
#include "support/test_domain.hpp"
#include "support/wait_until.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace twist_inputs_test {

using namespace sonopose;
using Catch::Matchers::Contains;
using ros2::relay::InputMonitor;
using ros2::relay::TwistInput;

constexpr TimeNs second_ns = 1'000'000'000;

SCENARIO("options of velocities") {
  GIVEN("topics with addresses") {
    THEN("they are parsed") {
      const auto odometry = TwistInput::parse_odometry("/odom=7");
      CHECK(odometry.type == TwistInput::Type::odometry);
      CHECK(odometry.topic == "/odom");
      CHECK(odometry.address == 7);
      CHECK(TwistInput::parse_twist("/wheel=7").type == TwistInput::Type::twist_with_covariance);
      const auto stamped = TwistInput::parse_twist("/wheel:TwistStamped=8");
      CHECK(stamped.type == TwistInput::Type::twist);
      CHECK(stamped.topic == "/wheel");
      CHECK(stamped.address == 8);
    }
  }
  GIVEN("mistakes") {
    THEN("they are named") {
      CHECK_THROWS_WITH(TwistInput::parse_odometry("/odom"),
                        Contains("--odom-in /odom: expected TOPIC=ADDRESS"));
      CHECK_THROWS_WITH(TwistInput::parse_odometry("/odom=70000"),
                        Contains("--odom-in /odom=70000: '70000' is not an address from 0 to 65534"));
      CHECK_THROWS_WITH(TwistInput::parse_twist("/wheel:Twist=7"), Contains("'Twist' is not"));
      CHECK_THROWS_WITH(ros2::relay::check(std::vector{TwistInput::parse_odometry("/odom=7"),
                                                       TwistInput::parse_twist("/wheel=7")}),
                        Contains("only one source of velocities, not /odom and /wheel"));
    }
  }
}

SCENARIO("velocities of drivers become samples") {
  GIVEN("a driver of odometry, and one of TwistStamped") {
    const test::TestDomain domain;
    const dds::qos::Provider qos;
    const auto participant = dds::make_participant({.domain_id = domain.id()});
    const auto drivers = dds::make_participant({.domain_id = domain.id()});
    ros2::Node node(participant, qos, ros2::NameResolver({}), ros2::Distro::jazzy);
    ros2::Mount mount;
    ros2::relay::TwistInputs inputs(
        node, {TwistInput::parse_odometry("/odom=7"), TwistInput::parse_twist("/wheel:TwistStamped=8")},
        [&mount](BeaconAddress) { return mount; }, second_ns);
    dds::DataWriter<ros2::Odometry> odometry(drivers, dds::Topic<ros2::Odometry>(drivers, "rt/odom"));
    dds::DataWriter<ros2::TwistStamped> wheel(drivers, dds::Topic<ros2::TwistStamped>(drivers, "rt/wheel"));
    REQUIRE(test::wait_until([&] {
      return odometry.publication_matched_status().current_count > 0 &&
             wheel.publication_matched_status().current_count > 0;
    }));
    test::CollectingSink sink;
    InputMonitor::Lines lines;
    const auto take_until = [&](const auto& condition) {
      return test::wait_until([&] {
        inputs.take(
            sink, [](BeaconAddress) { return TimeNs{5'000'000'000}; }, lines);
        return condition();
      });
    };
    WHEN("they publish") {
      std::string frame = "odom";
      ros2::Odometry message{};
      message.header.frame_id = frame.data();
      message.child_frame_id = frame.data();
      message.twist.twist.linear.x = 1.5;
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
      }
    }
    WHEN("a driver publishes two messages without a measured axis") {
      std::string frame = "odom";
      ros2::Odometry message{};
      message.header.frame_id = frame.data();
      message.child_frame_id = frame.data();
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

}  // namespace twist_inputs_test
