/// What is told of an input from ROS 2, without ROS 2.

#include "ros2/relay/input_detector.hpp"

#include <catch2/catch.hpp>

#include <stdexcept>

namespace {

using namespace sonopose;
using ros2::Ros2Input;
using ros2::Ros2InputDetector;
using ros2::Ros2InputEnds;
using Kind = Ros2Input::Kind;
using Catch::Matchers::Contains;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs second = 1000 * ms;

/// A watch of `/imu/data=42` or `/tag=42` that began at 0, and what it has said since it was asked last.
struct Told {
  explicit Told(Kind kind)
      : watch({kind, kind == Kind::imu ? "/imu/data" : "/tag", 42}, "map", 100 * ms, 0) {}

  Ros2InputDetector::Lines take() { return std::exchange(lines, {}); }
  Ros2InputDetector::Lines look(const Ros2InputEnds& ends, TimeNs now_ns) {
    watch.look(ends, SteadyTime{now_ns}, lines);
    return take();
  }
  Ros2InputDetector::Lines hear(std::string_view frame, TimeNs now_ns = 0) {
    watch.on_sample(frame, SteadyTime{now_ns}, lines);
    return take();
  }

  Ros2InputDetector watch;
  Ros2InputDetector::Lines lines;
};

}  // namespace

SCENARIO("a beacon has one source of a kind in ROS 2") {
  GIVEN("two topics of IMU samples, or of fixes, for one address") {
    THEN("they are refused, and both are named") {
      CHECK_THROWS_WITH(ros2::check({{Kind::imu, "/a", 7}, {Kind::fix, "/b", 7}, {Kind::imu, "/c", 7}}),
                        Contains("--imu-in /a=7") && Contains("--imu-in /c=7"));
      CHECK_THROWS_WITH(ros2::check({{Kind::fix, "/a", 7}, {Kind::fix, "/b", 7}}),
                        Contains("--fix-in /a=7") && Contains("--fix-in /b=7"));
    }
  }
  GIVEN("one of each for two addresses, even of the same topics") {
    THEN("they go together") {
      CHECK_NOTHROW(ros2::check(
          {{Kind::imu, "/a", 7}, {Kind::fix, "/b", 7}, {Kind::imu, "/a", 8}, {Kind::fix, "/b", 8}}));
    }
  }
}

SCENARIO("an input that was never heard is told of, with the cause") {
  GIVEN("an IMU's topic that brings nothing from the start") {
    Told told(Kind::imu);
    const TimeNs timeout_ns = Ros2InputDetector::first_sample_ns;
    REQUIRE(told.look({}, timeout_ns - ms).empty());  // publishers have to be found first
    WHEN("nobody publishes it") {
      const auto lines = told.look({}, timeout_ns + ms);
      THEN("it says so, and says it once") {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Contains("beacon 42: no IMU samples from ROS 2 yet: nobody publishes") &&
                                 Contains("on /imu/data"));
        CHECK(told.look({}, 10 * timeout_ns).empty());
      }
      AND_WHEN("somebody comes whose QoS does not match") {
        THEN("that is told, too") {
          const auto more = told.look({.publishers_refused = 1}, 2 * timeout_ns);
          REQUIRE(more.size() == 1);
          CHECK_THAT(more[0], Contains("the QoS of 1 publisher of /imu/data does not match"));
          CHECK(told.look({.publishers_refused = 1}, 3 * timeout_ns).empty());
        }
      }
      AND_WHEN("the first sample comes") {
        told.hear("imu_link", 3 * timeout_ns);
        THEN("it is heard, but not again") {
          const auto more = told.look({.publishers = 1}, 3 * timeout_ns + ms);
          REQUIRE(more.size() == 1);
          CHECK_THAT(more[0], Contains("IMU samples from ROS 2, after 6.0 s"));
        }
      }
    }
    WHEN("somebody publishes it, but nothing comes") {
      const auto lines = told.look({.publishers = 1, .publishers_refused = 1}, timeout_ns + ms);
      THEN("it says so") {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Contains("/imu/data has 1 publisher, but nothing usable comes"));
      }
    }
  }
}

SCENARIO("an input that falls silent is told of by its timeout") {
  GIVEN("fixes that were heard at 5 s") {
    Told told(Kind::fix);
    told.hear("map", 5 * second);
    REQUIRE(told.look({.publishers = 1}, 5 * second + 100 * ms).empty());
    WHEN("none comes for longer than the timeout") {
      const auto lines = told.look({}, 5 * second + 200 * ms);
      THEN("it says for how long and why, and when they are back") {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Contains("beacon 42: no fixes from ROS 2 for 0.2 s: nobody publishes"));
        CHECK(told.look({}, 6 * second).empty());
        told.hear("map", 8 * second);
        const auto back = told.look({.publishers = 1}, 8 * second + ms);
        REQUIRE(back.size() == 1);
        CHECK_THAT(back[0], Contains("beacon 42: fixes from ROS 2 again, after 3.0 s"));
      }
    }
  }
}

SCENARIO("losses of an input are told of once a second where they rose") {
  GIVEN("an IMU's topic of which samples were lost") {
    Told told(Kind::imu);
    told.hear("imu_link", second);
    const auto lines = told.look({.samples_lost = 12}, second + ms);
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Contains("beacon 42: 12 IMU samples from ROS 2 lost") && Contains("/imu/data"));
    THEN("more within that second wait for its end, and what did not rise is not told") {
      told.hear("imu_link", second + 999 * ms);
      CHECK(told.look({.samples_lost = 15}, second + 999 * ms).empty());
      told.hear("imu_link", 2 * second + ms);
      const auto more = told.look({.samples_lost = 17}, 2 * second + ms);
      REQUIRE(more.size() == 1);
      CHECK_THAT(more[0], Contains(" 5 IMU samples"));
      told.hear("imu_link", 4 * second);
      CHECK(told.look({.samples_lost = 17}, 4 * second).empty());
    }
  }
}

SCENARIO("frames that are not what samples are taken as are told of once") {
  GIVEN("fixes") {
    Told told(Kind::fix);
    CHECK(told.hear("map").empty());
    CHECK(told.hear("/map").empty());  // as tf2's elders wrote it
    const auto lines = told.hear("uwb");
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Contains("beacon 42: fixes on /tag are in frame 'uwb'") && Contains("'map'"));
    CHECK(told.hear("uwb").empty());
    CHECK(told.hear("map").empty());
    CHECK(told.hear("uwb").empty());
    CHECK(told.hear("other").size() == 1);
  }
  GIVEN("IMU samples, whose frame is their driver's own") {
    Told told(Kind::imu);
    CHECK(told.hear("imu_a").empty());
    const auto lines = told.hear("imu_b");
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Contains("'imu_b'") && Contains("'imu_a'"));
  }
  GIVEN("a driver that makes up a frame for each message") {
    Told told(Kind::fix);
    std::size_t lines = 0;
    for (int i = 0; i < 1000; ++i) lines += told.hear("frame_" + std::to_string(i)).size();
    THEN("it is not told of for ever") {
      CHECK(lines >= 1);
      CHECK(lines < 20);
    }
  }
}

SCENARIO("the offset of the clocks is the smallest of the last second") {
  ros2::SmallestOffset offset;
  CHECK(offset.value_s() == 0);
  offset.add(0.003, SteadyTime{0});
  offset.add(0.001, SteadyTime{100 * ms});
  offset.add(0.250, SteadyTime{200 * ms});
  CHECK(offset.value_s() == 0.001);
  offset.add(0.004, SteadyTime{1050 * ms});
  CHECK(offset.value_s() == 0.001);
  offset.add(0.005, SteadyTime{1150 * ms});  // 0.001 is older than a second now
  CHECK(offset.value_s() == 0.004);
}
