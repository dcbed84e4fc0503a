/// Drivers' topics as a source of a bridge: streams, clocks, lines of the log and readers.

#include "ros2/relay/source.hpp"

#include "clocks/clocks.hpp"
#include "ros2/relay/source_rig.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/messages.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

namespace sonopose::source_test {

using namespace source_rig;

SCENARIO("a stalled input queues messages, and logs losses") {
  GIVEN("a source that does not run while an IMU writes 1500 samples without a stamp") {
    constexpr std::size_t written = 1500;
    Rig rig({{Kind::imu, "/imu/data", 7, ImuMeaning::mean_since_last}, {Kind::imu, "/other", 8}});
    auto imu = rig.driver<ros2::Imu>("/imu/data");
    for (std::size_t i = 0; i < written; ++i) imu.write(imu_at(0));
    WHEN("it runs") {
      rig.run();
      THEN("queued samples arrive, and the others are counted and logged for this beacon only") {
        REQUIRE(rig.logs("IMU samples from ROS 2 lost"));
        REQUIRE(wait_until([&] { return rig.sink.count() + rig.source->samples_lost(7) == written; }));
        CHECK(rig.sink.count() >= 64);
        CHECK(rig.source->samples_lost(7) > 0);
        CHECK(rig.source->samples_lost(8) == 0);
        CHECK(rig.source->samples_lost(9) == 0);
        CHECK(rig.has_logged("beacon 7: " + std::to_string(rig.source->samples_lost(7)) + " IMU samples"));
      }
      THEN("each has a unique time, and the meaning that the user declares") {
        REQUIRE(wait_until([&] { return rig.sink.count() >= 64; }));
        const auto samples = rig.sink.imu_samples();
        for (const ImuSample& sample : samples) CHECK(sample.meaning == ImuMeaning::mean_since_last);
        CHECK(std::adjacent_find(samples.begin(), samples.end(), [](const auto& one, const auto& next) {
                return next.sensor_time_ns <= one.sensor_time_ns;
              }) == samples.end());
      }
      THEN("later samples arrive") {
        REQUIRE(wait_until([&] { return rig.sink.count() > 0; }));
        const TimeNs stamp_ns = 1234 * second_ns;
        REQUIRE(wait_until([&] {
          imu.write(imu_at(stamp_ns));
          return rig.sink.imu_samples().back().sensor_time_ns == stamp_ns;
        }));
      }
    }
  }
}

SCENARIO("the clock offset of a beacon is the minimum age of its IMU samples") {
  GIVEN("beacon 7 with IMU samples of 100 s and 500 s age, and younger fixes") {
    Rig rig({{Kind::fix, "/tag", 7}, {Kind::imu, "/imu/data", 7}, {Kind::fix, "/tag", 8}});
    auto imu = rig.driver<ros2::Imu>("/imu/data");
    auto fixes = rig.driver<ros2::PointStamped>("/tag");
    imu.write(imu_at(clocks::host_now() - 100 * second_ns));
    imu.write(imu_at(clocks::host_now() - 500 * second_ns));
    fixes.write(fix_at(clocks::host_now() - second_ns, {}));
    rig.run();
    const auto offset_s = [&](BeaconAddress address) {
      double result = 0;
      REQUIRE(wait_until([&] {
        for (const BeaconStatus& status : rig.sink.statuses()) {
          if (status.address == address) result = status.clock_offset_s;
        }
        return result != 0;
      }));
      return result;
    };
    THEN("the offset is that of the youngest IMU sample, or of the fixes without an IMU") {
      REQUIRE(wait_until([&] { return rig.sink.count() == 4; }));
      CHECK(offset_s(7) >= 100);
      CHECK(offset_s(7) < 400);
      CHECK(offset_s(8) >= 1);
      CHECK(offset_s(8) < 100);
    }
  }
}

SCENARIO("the delay of a fix is measured in the clock of the stamps") {
  GIVEN("a recording of a day ago that is played back: fixes arrive 200 ms after their stamps") {
    constexpr TimeNs day_ns = 86'400 * second_ns;
    Rig rig({{Kind::imu, "/imu/data", 7}, {Kind::fix, "/tag", 7}});
    auto imu = rig.driver<ros2::Imu>("/imu/data");
    auto fixes = rig.driver<ros2::PointStamped>("/tag");
    rig.run();
    const TimeNs begin_ns = clocks::host_now();
    imu.write(imu_at(begin_ns - day_ns));
    REQUIRE(wait_until([&] { return rig.sink.count() == 1; }));
    const double max_early_s =
        seconds_between(begin_ns, clocks::host_now());  // largest error of the clock offset
    const TimeNs stamp_ns = clocks::host_now() - day_ns - second_ns / 5;
    WHEN("one has a stamp") {
      fixes.write(fix_at(stamp_ns, {}));
      REQUIRE(wait_until([&] { return rig.sink.count() == 2; }));
      const double max_s = seconds_between(stamp_ns + day_ns, clocks::host_now());
      const UltrasonicFix fix = rig.sink.fixes().front();
      THEN("its delay is these 200 ms, and what the machine needs, not a day") {
        CHECK(fix.emission_time_ns == stamp_ns);
        CHECK(fix.measured_delay_s.value_or(-1) >= 0.2 - max_early_s);
        CHECK(fix.measured_delay_s.value_or(-1) <= max_s);
      }
    }
    WHEN("one has no stamp") {
      fixes.write(fix_at(0, {}));
      REQUIRE(wait_until([&] { return rig.sink.count() == 2; }));
      const double max_s = seconds_between(stamp_ns + day_ns, clocks::host_now());
      THEN("it was measured at its reception, in the clock of the IMU") {
        const UltrasonicFix fix = rig.sink.fixes().front();
        CHECK(seconds_between(stamp_ns, fix.emission_time_ns) >= 0.2 - max_early_s);
        CHECK(seconds_between(stamp_ns, fix.emission_time_ns) <= max_s);
        CHECK(fix.measured_delay_s.value_or(-1) == 0.0);
      }
    }
  }
}

SCENARIO("lines about inputs that nobody takes are bounded and counted") {
  GIVEN("80 inputs of a topic whose messages come in eight frames that none of them expects") {
    constexpr std::size_t inputs = 80;
    constexpr std::size_t frames = 8;
    std::vector<Input> options;
    for (BeaconAddress address = 1; address <= inputs; ++address)
      options.push_back({Kind::fix, "/tag", address});
    Rig rig(options);
    auto fixes = rig.driver<ros2::PointStamped>("/tag");
    REQUIRE(wait_until([&] { return fixes.publication_matched_status().current_count() == inputs; }));
    for (std::size_t i = 0; i < frames; ++i) {
      fixes.write(fix_at(clocks::host_now(), {.map = "map_" + std::to_string(i)}));
    }
    WHEN("the source runs for a time before its lines are taken") {
      rig.run();
      REQUIRE(wait_until([&] { return rig.sink.count() == inputs * frames; }));
      THEN("the log has the number of those that are missing") {
        REQUIRE(rig.logs("further lines about the inputs were not logged"));
        std::size_t logged = 0;
        std::size_t missing = 0;
        REQUIRE(wait_until([&] {
          rig.source->log_changes();
          std::tie(logged, missing) = rig.lines_and_missing();
          return logged + missing >= inputs * frames;
        }));
        CHECK(logged + missing == inputs * frames);
        CHECK(logged <= 512);  // 256 before the first check, and 256 of the rest
      }
    }
  }
}

SCENARIO("inputs without samples are logged, each with its cause") {
  GIVEN("an IMU with incompatible QoS, a silent one, and a position without a publisher") {
    Rig rig({{Kind::imu, "/refused", 7}, {Kind::imu, "/mute", 8}, {Kind::fix, "/tag", 7}});
    const auto exclusive = dds::Qos() << dds::policy::Ownership::Exclusive();
    const auto refused = rig.driver<ros2::Imu>("/refused", exclusive, false);
    const auto mute = rig.driver<ros2::Imu>("/mute");
    rig.run();
    THEN("all three are logged") {
      CHECK(rig.logs("beacon 7: no IMU samples from ROS 2 yet: the QoS of 1 publisher of /refused"));
      CHECK(rig.logs("beacon 8: no IMU samples from ROS 2 yet: /mute has 1 publisher, but no valid message"));
      CHECK(rig.logs("beacon 7: no fixes from ROS 2 yet: there is no publisher"));
    }
  }
}

SCENARIO("fixes in an unexpected frame are used and logged") {
  GIVEN("two beacons with different map frames, and fixes in the frame of the first") {
    Rig rig({{Kind::fix, "/tag", 7}, {Kind::fix, "/tag", 8}}, "map_{address}");
    auto fixes = rig.driver<ros2::PointStamped>("/tag");
    ros2::FrameNames frames;
    frames.map = "map_7";
    fixes.write(fix_at(clocks::host_now(), frames));
    rig.run();
    THEN("only the second is logged, and both receive the fix") {
      REQUIRE(wait_until([&] { return rig.sink.count() == 2; }));
      CHECK(rig.logs("beacon 8: fixes on /tag are in frame 'map_7': they are used as if in 'map_8'"));
      CHECK_FALSE(rig.has_logged("beacon 7: fixes on /tag are in frame"));
      CHECK_FALSE(rig.has_logged_on_path());
    }
  }
}

/// Types of the readers discovered on a topic.
std::vector<std::string> reader_types(const Rig& rig, const std::string& topic) {
  std::vector<std::string> types;
  for (const auto& reader : dds::Discovery(rig.drivers()).readers()) {
    if (reader.topic_name == ros2::name_in_dds(topic)) types.push_back(reader.type_name);
  }
  return types;
}

SCENARIO("a topic of fixes has one reader, of the type of its publisher") {
  const std::string point_type = "geometry_msgs::msg::dds_::PointStamped_";
  GIVEN("a topic without a publisher") {
    Rig rig({{Kind::fix, "/tag", 7}});
    rig.source->update_readers();
    THEN("it has no reader, which would give the topic a type") {
      CHECK(reader_types(rig, "/tag").empty());
    }
    WHEN("a publisher of points appears, then one of poses, then one of odometry") {
      auto points = rig.driver<ros2::PointStamped>("/tag");
      const auto poses = rig.driver<ros2::PoseWithCovarianceStamped>("/tag", {}, false);
      const auto odometry = rig.driver<ros2::Odometry>("/tag", {}, false);
      THEN("the only reader has the first type, and the others are logged with theirs") {
        rig.run();
        points.write(fix_at(clocks::host_now(), {}));
        CHECK(wait_until([&] { return rig.sink.count() == 1; }));
        const auto logs = [&](const std::string& type) {
          return wait_until([&] {
            rig.source->update_readers();
            return rig.has_logged("a publisher of /tag is ignored, because its type is " + type +
                                  ", not geometry_msgs/msg/PointStamped");
          });
        };
        CHECK(logs("geometry_msgs/msg/PoseWithCovarianceStamped"));
        CHECK(logs("nav_msgs/msg/Odometry"));
        CHECK(rig.has_logged("PointStamped; --pose-in /tag:Odometry takes it, with its orientation"));
        CHECK(reader_types(rig, "/tag") == std::vector{point_type});
      }
    }
  }
  GIVEN("a topic whose type the user declares") {
    const Rig rig({Input::parse(Kind::fix, "/tag:geometry_msgs/msg/PointStamped=7")});
    THEN("it has a reader before any publisher") {
      CHECK(wait_until([&] { return reader_types(rig, "/tag") == std::vector{point_type}; }));
    }
  }
}

SCENARIO("two publishers of one input are named") {
  GIVEN("a driver of fixes, and a second one on its topic") {
    Rig rig({Input::parse(Kind::fix, "/tag:PointStamped=7")});
    auto driver = rig.driver<ros2::PointStamped>("/tag");
    auto second = rig.driver<ros2::PointStamped>("/tag");
    rig.run();
    std::size_t sent = 0;
    const auto send = [&](auto& writer) {
      writer.write(fix_at(clocks::host_now(), {}));
      ++sent;
      REQUIRE(wait_until([&] { return rig.sink.count() == sent; }));
    };
    WHEN("only the first one sends, and then only the second") {
      for (int i = 0; i < 4; ++i) send(driver);
      for (int i = 0; i < 4; ++i) send(second);
      THEN("nothing is said") {
        rig.source->log_changes();
        CHECK_FALSE(rig.has_logged("several publishers"));
      }
    }
    WHEN("they send in turn") {
      for (int i = 0; i < 4; ++i) {
        send(driver);
        send(second);
      }
      THEN("they are said to mix") {
        CHECK(rig.logs("/tag has several publishers at a time"));
      }
    }
  }
}

SCENARIO("a source does not mix two positioning systems") {
  GIVEN("two topics of fixes for one beacon") {
    THEN("it is rejected") {
      CHECK_THROWS_AS(Rig({{Kind::fix, "/a", 7}, {Kind::fix, "/b", 7}}), std::invalid_argument);
    }
  }
}

}  // namespace sonopose::source_test
