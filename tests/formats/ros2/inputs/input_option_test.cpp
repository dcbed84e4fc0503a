/// Options and log lines of inputs from ROS 2.

#include "ros2/inputs/input_monitor.hpp"

#include <catch2/catch.hpp>

namespace input_option_test {

using namespace sonopose;
using ros2::Input;
using ros2::InputEndpoints;
using ros2::InputMonitor;
using Kind = Input::Kind;
using Catch::Matchers::Contains;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs second = 1000 * ms;

/// A monitor of `/imu/data=42` or `/tag=42` since time 0, and its new lines.
struct Log {
  explicit Log(Kind kind)
      : monitor({kind, kind == Kind::imu ? "/imu/data" : "/tag", 42}, "map", 100 * ms, SteadyTime{}) {}

  /// Forms the lines after the fact, as the relay does.
  std::vector<std::string> take() {
    std::vector<std::string> formed;
    for (const InputMonitor::Line& line : std::exchange(lines, {})) formed.push_back(line.text());
    return formed;
  }
  std::vector<std::string> update(const InputEndpoints& endpoints, TimeNs now_ns) {
    monitor.update(endpoints, SteadyTime{now_ns}, lines);
    return take();
  }
  std::vector<std::string> receive(std::string_view frame, TimeNs now_ns = 0) {
    monitor.on_sample(frame, SteadyTime{now_ns}, lines);
    return take();
  }

  InputMonitor monitor;
  InputMonitor::Lines lines;
};

SCENARIO("a beacon has one source of each kind in ROS 2") {
  GIVEN("an IMU as the topics of its accelerometer and of its gyroscope") {
    THEN("they are accepted, but no third one, nor the same one twice") {
      CHECK_NOTHROW(ros2::check({{Kind::imu, "/a", 7}, {Kind::fix, "/b", 7}, {Kind::imu, "/c", 7}}));
      CHECK_THROWS_WITH(ros2::check({{Kind::imu, "/a", 7}, {Kind::imu, "/b", 7}, {Kind::imu, "/c", 7}}),
                        Contains("--imu-in /a=7") && Contains("beacon 7 can have two topics of IMU samples"));
      CHECK_THROWS_WITH(ros2::check({{Kind::imu, "/a", 7}, {Kind::imu, "/a", 7}}), Contains("--imu-in /a=7"));
    }
  }
  GIVEN("two topics of fixes for one address") {
    THEN("they are rejected with both names") {
      CHECK_THROWS_WITH(ros2::check({{Kind::fix, "/a", 7}, {Kind::fix, "/b", 7}}),
                        Contains("--fix-in /a=7") && Contains("--fix-in /b=7"));
    }
  }
  GIVEN("one of each kind for two addresses, even with the same topics") {
    THEN("they are accepted") {
      CHECK_NOTHROW(ros2::check(
          {{Kind::imu, "/a", 7}, {Kind::fix, "/b", 7}, {Kind::imu, "/a", 8}, {Kind::fix, "/b", 8}}));
    }
  }
}

SCENARIO("the type of a topic of fixes may be declared") {
  for (const char* const text : {"/tag:PointStamped=7", "/tag:geometry_msgs/PointStamped=7",
                                 "/tag:geometry_msgs/msg/PointStamped=7"}) {
    const Input input = Input::parse(Kind::fix, text);
    CHECK(input.topic == "/tag");
    CHECK(input.fix_type == ros2::FixType::point);
    CHECK(text_of(input) == "--fix-in /tag:PointStamped=7");
  }
  CHECK(Input::parse(Kind::fix, "/tag:PoseWithCovarianceStamped=7").fix_type == ros2::FixType::pose);
  CHECK_FALSE(Input::parse(Kind::fix, "/tag=7").fix_type);
  CHECK_THROWS_WITH(Input::parse(Kind::fix, "/tag:Odometry=7"),
                    Contains("'Odometry' is not PointStamped or PoseWithCovarianceStamped"));
}

SCENARIO("tags of one beacon have places") {
  GIVEN("a frame of tf, or a place on the base") {
    THEN("they are parsed after the address") {
      const Input by_frame = Input::parse(Kind::fix, "/tag:PointStamped=7@tag_left");
      CHECK(by_frame.tag_frame == "tag_left");
      CHECK(by_frame.address == 7);
      CHECK(by_frame.fix_type == ros2::FixType::point);
      CHECK(Input::parse(Kind::fix, "/tag=7@0.2,-0.1,0.5").tag_base_m == Vector3d(0.2, -0.1, 0.5));
      CHECK_THROWS_WITH(Input::parse(Kind::fix, "/tag=7@0.2,x,0"), Contains("'0.2,x,0' is neither a frame"));
      CHECK_THROWS_WITH(Input::parse(Kind::fix, "/tag=7@"), Contains("'' is neither a frame"));
    }
    THEN("several may be of one beacon, of which one may be at the tracked point") {
      const auto input = [](const char* text) { return Input::parse(Kind::fix, text); };
      CHECK_NOTHROW(ros2::check({input("/a=7@left"), input("/b=7@right"), input("/c=7")}));
      CHECK_THROWS_WITH(ros2::check({input("/a=7"), input("/b=7"), input("/c=7@right")}),
                        Contains("only one source of fixes, unless its tags have places"));
    }
  }
}

SCENARIO("stamps of another clock are named with the remedy") {
  CHECK_THAT(ros2::clocks_text(-0.3, Kind::fix, "/imu"), Contains("0.300 s newer than those of /imu") &&
                                                             Contains("so their clocks differ") &&
                                                             Contains("delay.correction_s = 0.300"));
  CHECK_THAT(ros2::clocks_text(0.12, Kind::pose, "/imu"),
             Contains("0.120 s older") && Contains("unless this is the latency") &&
                 Contains("delay.correction_s = -0.120 plus that latency"));
  CHECK_THAT(ros2::clocks_text(0.7, Kind::fix, "/imu"), !Contains("correction_s"));
  CHECK_THAT(ros2::clocks_text(0.12, Kind::twist, "/imu"),
             Contains("the latency of the velocities") && !Contains("correction_s"));  // it would move fixes
}

SCENARIO("an input without any sample is logged, with the cause") {
  GIVEN("an IMU topic without samples") {
    Log log(Kind::imu);
    const TimeNs timeout_ns = InputMonitor::first_sample_ns;
    REQUIRE(log.update({}, timeout_ns - ms).empty());  // waits for discovery
    WHEN("there is no publisher") {
      const auto lines = log.update({}, timeout_ns + ms);
      THEN("this is logged once") {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Contains("beacon 42: no IMU samples from ROS 2 yet: there is no publisher") &&
                                 Contains("on /imu/data"));
        CHECK(log.update({}, 10 * timeout_ns).empty());
      }
      AND_WHEN("a publisher with incompatible QoS appears") {
        THEN("this is logged too") {
          const auto more = log.update({.publishers_incompatible = 1}, 2 * timeout_ns);
          REQUIRE(more.size() == 1);
          CHECK_THAT(more[0], Contains("the QoS of 1 publisher of /imu/data does not match"));
          CHECK(log.update({.publishers_incompatible = 1}, 3 * timeout_ns).empty());
        }
      }
      AND_WHEN("the first sample arrives") {
        log.receive("imu_link", 3 * timeout_ns);
        THEN("this is logged, not as a return") {
          const auto more = log.update({.publishers = 1}, 3 * timeout_ns + ms);
          REQUIRE(more.size() == 1);
          CHECK_THAT(more[0], Contains("IMU samples from ROS 2, after 6.0 s"));
        }
      }
    }
    WHEN("there is a publisher, but no samples") {
      const auto lines = log.update({.publishers = 1, .publishers_incompatible = 1}, timeout_ns + ms);
      THEN("this is logged") {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Contains("/imu/data has 1 publisher, but no valid message has arrived"));
      }
    }
  }
}

SCENARIO("a silent input is logged after its timeout") {
  GIVEN("a fix received at 5 s") {
    Log log(Kind::fix);
    log.receive("map", 5 * second);
    REQUIRE(log.update({.publishers = 1}, 5 * second + 100 * ms).empty());
    WHEN("the silence exceeds the timeout") {
      const auto lines = log.update({}, 5 * second + 200 * ms);
      THEN("duration and cause are logged, and the return") {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Contains("beacon 42: no fixes from ROS 2 for 0.2 s: there is no publisher"));
        CHECK(log.update({}, 6 * second).empty());
        log.receive("map", 8 * second);
        const auto back = log.update({.publishers = 1}, 8 * second + ms);
        REQUIRE(back.size() == 1);
        CHECK_THAT(back[0], Contains("beacon 42: fixes from ROS 2 again, after 3.0 s"));
      }
    }
  }
}

SCENARIO("increases of losses are logged once per second") {
  GIVEN("an IMU topic with lost samples") {
    Log log(Kind::imu);
    log.receive("imu_link", second);
    const auto lines = log.update({.samples_lost = 12}, second + ms);
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Contains("beacon 42: 12 IMU samples from ROS 2 lost") && Contains("/imu/data"));
    THEN("further losses are logged after one second, and an unchanged count is not logged") {
      log.receive("imu_link", second + 999 * ms);
      CHECK(log.update({.samples_lost = 15}, second + 999 * ms).empty());
      log.receive("imu_link", 2 * second + ms);
      const auto more = log.update({.samples_lost = 17}, 2 * second + ms);
      REQUIRE(more.size() == 1);
      CHECK_THAT(more[0], Contains(" 5 IMU samples"));
      log.receive("imu_link", 4 * second);
      CHECK(log.update({.samples_lost = 17}, 4 * second).empty());
    }
  }
}

SCENARIO("unexpected frames are logged once") {
  GIVEN("fixes") {
    Log log(Kind::fix);
    CHECK(log.receive("map").empty());
    CHECK(log.receive("/map").empty());  // tf2's old syntax
    const auto lines = log.receive("uwb");
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Contains("beacon 42: fixes on /tag are in frame 'uwb'") && Contains("'map'"));
    CHECK(log.receive("uwb").empty());
    CHECK(log.receive("map").empty());
    CHECK(log.receive("uwb").empty());
    CHECK(log.receive("other").size() == 1);
  }
  GIVEN("IMU samples, which may have any frame") {
    Log log(Kind::imu);
    CHECK(log.receive("imu_a").empty());
    const auto lines = log.receive("imu_b");
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Contains("'imu_b'") && Contains("'imu_a'"));
  }
  GIVEN("a driver with a new frame in each message") {
    Log log(Kind::fix);
    std::size_t lines = 0;
    for (int i = 0; i < 1000; ++i) lines += log.receive("frame_" + std::to_string(i)).size();
    THEN("the number of lines is limited") {
      CHECK(lines >= 1);
      CHECK(lines < 20);
    }
  }
}

SCENARIO("the clock offset is the minimum of the last second") {
  ros2::SmallestOffset offset;
  CHECK(offset.value_s() == 0);
  offset.add(0.003, SteadyTime{0});
  offset.add(0.001, SteadyTime{100 * ms});
  offset.add(0.250, SteadyTime{200 * ms});
  CHECK(offset.value_s() == 0.001);
  offset.add(0.004, SteadyTime{1050 * ms});
  CHECK(offset.value_s() == 0.001);
  offset.add(0.005, SteadyTime{1150 * ms});  // 0.001 is now older than one second
  CHECK(offset.value_s() == 0.004);
}

TEST_CASE("the type of an IMU's topic may be given") {
  CHECK(Input::parse(Kind::imu, "/imu=7").imu_type == ros2::ImuType::ros);
  CHECK(Input::parse(Kind::imu, "/imu:Imu=7").topic == "/imu");
  const Input px4 = Input::parse(Kind::imu, "/fmu/out/sensor_combined:px4_msgs/msg/SensorCombined=7");
  CHECK(px4.imu_type == ros2::ImuType::px4);
  CHECK(text_of(px4) == "--imu-in /fmu/out/sensor_combined:SensorCombined=7");
  CHECK(message_type_of(px4) == "px4_msgs::msg::dds_::SensorCombined_");
  CHECK_THROWS_WITH(Input::parse(Kind::imu, "/imu:Odometry=7"), Contains("'Odometry' is not Imu or"));
}

}  // namespace input_option_test
