/// The relay's transforms.

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "process/stop_signal.hpp"
#include "ros2/relay/relay.hpp"
#include "support/ros2.hpp"
#include "support/wait_until.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <map>
#include <set>
#include <string>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace sonopose::ros2_tf_test {

using namespace sonopose::test;
namespace topics = dds::topics;

struct SeenTransform {
  TimeNs stamp_ns = 0;
  std::string parent;
  std::string child;
  ros2::Transform transform;
};

std::vector<SeenTransform> seen(const ros2::TFMessage& message) {
  std::vector<SeenTransform> all;
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const ros2::TransformStamped& one = message.transforms._buffer[i];
    const auto& [x, y, z] = one.transform.translation;
    const ros2::Quaternion& q = one.transform.rotation;
    all.push_back({stamp_of(one.header),
                   one.header.frame_id,
                   one.child_frame_id,
                   {{x, y, z}, Quaterniond(q.w, q.x, q.y, q.z)}});
  }
  return all;
}

SCENARIO("the transform tree contains the robot and the mount of its IMU") {
  GIVEN("a running chain, and a relay that knows the mount") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    RosReader<ros2::TFMessage> tf(bus, "/tf");
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--mount", "0.2", "0", "0.5", "0", "0", "90"});
    const auto bridge = bus.bridge({"--scenario", "walk"});
    THEN("map → base_link → imu_link gives the fused pose, and no stamp is repeated") {
      std::map<TimeNs, SeenTransform> moving;
      REQUIRE(tf.wait_for_count(30, [&](const auto& message) {
        for (const auto& one : seen(message)) {
          CHECK(one.parent == "map");
          CHECK(one.child == "base_link");
          CHECK(moving.emplace(one.stamp_ns, one).second);
        }
      }));
      // A late subscriber receives the mount too.
      RosReader<ros2::TFMessage> late(bus, "/tf_static", Subscription::latched);
      std::vector<SeenTransform> fixed;
      REQUIRE(late.wait_for_count(1, [&](const auto& message) { fixed = seen(message); }));
      REQUIRE(fixed.size() == 1);
      CHECK(fixed[0].parent == "base_link");
      CHECK(fixed[0].child == "imu_link");
      REQUIRE(poses.wait_for([&](const FusedPose& pose) {
        const auto found = moving.find(pose.time_ns);
        if (found == moving.end()) return false;
        const ros2::Transform imu = found->second.transform * fixed[0].transform;
        CHECK((imu.translation_m - pose.position_world_m).norm() < 1e-9);
        CHECK(imu.rotation.angularDistance(pose.q_body_to_world) < 1e-7);
        return true;
      }));
    }
  }
}

SCENARIO("with another odometry the relay publishes the transform of its frame") {
  GIVEN("wheel odometry, and a relay in mode map_odom") {
    const Bus bus;
    RosReader<ros2::TFMessage> tf(bus, "/tf");
    RosReader<ros2::Odometry> odometry(bus, "/hedge_7/odom");
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--tf", "map_odom"});
    const auto bridge = bus.bridge({});
    RosWriter<ros2::TFMessage> wheels(bus, "/tf");
    REQUIRE(odometry.wait_for_count(1, [](const auto&) {}));
    const std::string odom = "odom";
    const std::string base = "base_link";
    const ros2::Transform base_in_odom{{3, -1, 0}, Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()))};
    WHEN("the wheel odometry stays at (3, -1)") {
      std::atomic<bool> enough = false;
      std::thread driver([&] {
        while (!enough) {
          auto transform = ros2::transform(base_in_odom, clocks::host_now(), odom, base);
          wheels.write({{1, 1, &transform, false}});
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
      });
      std::map<TimeNs, SeenTransform> of_odom;
      SeenTransform map_to_odom;
      ros2::Transform base_in_map;
      const bool compared = odometry.wait_for([&](const auto& message) {
        tf.take([&](const auto& transforms) {
          for (const SeenTransform& one : seen(transforms)) {
            if (one.child == "odom") of_odom.emplace(one.stamp_ns, one);
          }
        });
        const auto found = of_odom.find(stamp_of(message.header));
        if (found == of_odom.end()) return false;
        map_to_odom = found->second;
        base_in_map = ros2::base_in_map(message);
        return true;
      });
      enough = true;
      driver.join();
      THEN("map → odom → base_link gives the fused pose") {
        REQUIRE(compared);
        CHECK(map_to_odom.parent == "map");
        const ros2::Transform through = map_to_odom.transform * base_in_odom;
        CHECK((through.translation_m - base_in_map.translation_m).norm() < 1e-9);
        CHECK(through.rotation.angularDistance(base_in_map.rotation) < 1e-7);
      }
    }
  }
}

SCENARIO("the mount is published unless another node has the transform tree") {
  GIVEN("a running chain") {
    const Bus bus;
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    const dds::domain::DomainParticipant participant = dds::ext::participant({.domain_id = bus.domain_id()});
    const dds::Discovery discovery(participant);
    const auto wait_for_odometry = [&](bool present) {
      std::set<std::string> topics;
      REQUIRE(wait_until([&] {
        topics.clear();
        for (const auto& writer : discovery.writers()) topics.insert(writer.topic_name);
        return topics.contains("rt/hedge_7/odom") == present;
      }));
      return topics;
    };
    const auto publishes_mount = [&](const Arguments& arguments) {
      const auto relay = bus.ros2(arguments);
      // The node creates its own writers before those of a beacon.
      const bool found = wait_for_odometry(true).contains("rt/tf_static");
      CHECK(relay->end_by(SIGTERM).code == 0);
      wait_for_odometry(false);
      return found;
    };
    THEN("it is with transforms, and not without; --tf-static decides otherwise") {
      CHECK(publishes_mount({}));
      CHECK_FALSE(publishes_mount({"--tf", "off"}));
      CHECK(publishes_mount({"--tf", "off", "--tf-static", "on"}));
      CHECK_FALSE(publishes_mount({"--tf-static", "off"}));
    }
  }
}

SCENARIO("the mount can come from the robot's own description") {
  GIVEN("a running chain, and a relay that reads the mount from /tf_static") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    RosReader<ros2::Odometry> odometry(bus, "/hedge_7/odom");
    RosReader<ros2::DiagnosticArray> diagnostics(bus, "/diagnostics");
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--mount-from-tf"});
    const auto bridge = bus.bridge({});
    const auto reports = [](const ros2::DiagnosticArray& message, const std::string& text) {
      for (std::uint32_t i = 0; i < message.status._length; ++i) {
        const std::string said = message.status._buffer[i].message;
        if (said.find(text) != std::string::npos) return true;
      }
      return false;
    };
    REQUIRE(diagnostics.wait_for(
        [&](const auto& message) { return reports(message, "/tf_static has no base_link -> imu_link"); }));
    WHEN("another node publishes it") {
      const std::string base = "base_link";
      const std::string imu = "imu_link";
      const ros2::Transform mount{{0.3, 0.1, 0.8}, Quaterniond(Eigen::AngleAxisd(1.5, Vector3d::UnitZ()))};
      const dds::domain::DomainParticipant participant =
          dds::ext::participant({.domain_id = bus.domain_id()});
      dds::pub::DataWriter<ros2::TFMessage> robot(
          dds::pub::Publisher(participant), dds::topic::Topic<ros2::TFMessage>(participant, "rt/tf_static"),
          qos_of(Subscription::latched));
      auto transform = ros2::transform(mount, clocks::host_now(), base, imu);
      robot.write({{1, 1, &transform, false}});
      THEN("the odometry is that of the base") {
        CHECK(relay->wait_for_line(Stream::error,
                                   "/tf_static has imu_link in base_link at (0.300, 0.100, 0.800)"));
        REQUIRE(odometry.wait_for([&](const auto& message) {
          poses.take();
          const auto pose = std::find_if(poses.samples.begin(), poses.samples.end(), [&](const auto& each) {
            return each.time_ns == stamp_of(message.header);
          });
          if (pose == poses.samples.end()) return false;
          const ros2::Transform imu_in_map = ros2::base_in_map(message) * mount;
          CHECK((imu_in_map.translation_m - pose->position_world_m).norm() < 1e-9);
          CHECK(imu_in_map.rotation.angularDistance(pose->q_body_to_world) < 1e-7);
          return true;
        }));
      }
    }
  }
}

SCENARIO("the relay gives way to a robot description that has the mount") {
  GIVEN("a running chain, and a relay that publishes a mount of its own") {
    const Bus bus;
    RosReader<ros2::TFMessage> fixed(bus, "/tf_static", Subscription::latched_log);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--mount", "1", "0", "0", "0", "0", "0"});
    const auto bridge = bus.bridge({});
    const auto wait_for_x = [&](double x_m) {
      return fixed.wait_for([&](const ros2::TFMessage& message) {
        for (const SeenTransform& one : seen(message)) {
          if (one.child == "imu_link" && std::abs(one.transform.translation_m.x() - x_m) < 1e-9) return true;
        }
        return false;
      });
    };
    REQUIRE(wait_for_x(1));
    WHEN("another node publishes another one") {
      const std::string base = "base_link";
      const std::string imu = "imu_link";
      const dds::domain::DomainParticipant participant =
          dds::ext::participant({.domain_id = bus.domain_id()});
      dds::pub::DataWriter<ros2::TFMessage> robot(
          dds::pub::Publisher(participant), dds::topic::Topic<ros2::TFMessage>(participant, "rt/tf_static"),
          qos_of(Subscription::latched));
      auto transform =
          ros2::transform({{0.3, 0.1, 0.8}, Quaterniond::Identity()}, clocks::host_now(), base, imu);
      robot.write({{1, 1, &transform, false}});
      THEN("it warns, and publishes the same") {
        CHECK(relay->wait_for_line(Stream::error, "another node publishes base_link -> imu_link"));
        std::size_t with_it = 0;
        CHECK(fixed.wait_for([&](const ros2::TFMessage& message) {
          for (const SeenTransform& one : seen(message)) {
            if (one.child == "imu_link" && std::abs(one.transform.translation_m.x() - 0.3) < 1e-9) ++with_it;
          }
          return with_it == 2;  // the robot's and the relay's
        }));
      }
    }
  }
}

SCENARIO("two beacons do not publish the same frame") {
  GIVEN("two beacons and a relay whose frame names do not contain the address") {
    const Bus bus;
    RosReader<ros2::TFMessage> tf(bus, "/tf");
    const auto fusion = bus.fusion();
    WHEN("both beacons appear") {
      const auto relay = bus.ros2();
      const auto bridge = bus.bridge({"--beacons", "2"});
      THEN("the relay reports that the second beacon has no transforms, and the remedy") {
        CHECK(relay->wait_for_line(Stream::error, "--base-frame hedge_{address}/base_link"));
      }
    }
    WHEN("the frame names contain the address") {
      const auto relay =
          bus.ros2({"--base-frame", "hedge_{address}/base_link", "--imu-frame", "hedge_{address}/imu_link"});
      const auto bridge = bus.bridge({"--beacons", "2"});
      THEN("both are in the tree") {
        std::set<std::string> children;
        CHECK(tf.wait_for([&](const auto& message) {
          for (const SeenTransform& one : seen(message)) children.insert(one.child);
          return children.size() == 2;
        }));
      }
    }
  }
}

/// A relay that treats a beacon as stale after 1 s and as gone after 5 s. It is a fork of this process, so
/// make it before any participant.
class ShortTimeoutRelay {
public:
  explicit ShortTimeoutRelay(const Bus& bus) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const logging::Session log(logging::Level::info);
    try {
      ros2::relay::Relay({.domain = {.domain_id = bus.domain_id()},
                          .qos_file = {},
                          .names = ros2::NameResolver({}),
                          .distro = {},
                          .addresses = {},
                          .output = {},
                          .inputs = {},
                          .aiding_inputs = {},
                          .startup_settings = {},
                          .presence = {.stale_after_ns = 1'000'000'000, .gone_after_ns = 5'000'000'000}})
          .run(process::StopSignal());
    } catch (const std::exception& error) {
      logging::failure(error.what());
    }
    std::_Exit(1);
  }
  ShortTimeoutRelay(const ShortTimeoutRelay&) = delete;
  ShortTimeoutRelay& operator=(const ShortTimeoutRelay&) = delete;
  ~ShortTimeoutRelay() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }

private:
  pid_t pid_;
};

SCENARIO("another beacon takes over the transforms of one that was switched off") {
  GIVEN("two beacons with the same frames, of which the first one has the transforms") {
    const Bus bus;
    const ShortTimeoutRelay relay(bus);
    RosReader<ros2::TFMessage> tf(bus, "/tf");
    RosReader<ros2::DiagnosticArray> diagnostics(bus, "/diagnostics");
    RosReader<ros2::LogMessage> log(bus, "/rosout", Subscription::latched_log);
    const auto is_logged = [&](const std::string& text) {
      return log.wait_for(
          [&](const auto& line) { return std::string(line.msg).find(text) != std::string::npos; });
    };
    const auto fusion = bus.fusion();
    auto first = bus.bridge({"--address", "7"});
    REQUIRE(tf.wait_for([](const auto&) { return true; }));
    const auto second = bus.bridge({"--address", "8"});
    REQUIRE(is_logged("beacon 8 has no transforms"));
    WHEN("the first one is switched off") {
      first.reset();
      const auto levels_of_first = [&](const ros2::DiagnosticArray& message) {
        std::set<int> levels;
        for (std::uint32_t i = 0; i < message.status._length; ++i) {
          const auto& status = message.status._buffer[i];
          if (std::string(status.hardware_id) == "7") levels.insert(status.level);
        }
        return levels;
      };
      THEN("its diagnostic becomes stale and then leaves, and the second one gets the transforms") {
        constexpr int stale = 3;
        CHECK(diagnostics.wait_for(
            [&](const auto& message) { return levels_of_first(message).contains(stale); }));
        CHECK(diagnostics.wait_for([&](const auto& message) { return levels_of_first(message).empty(); }));
        REQUIRE(is_logged("beacon 8 has the transforms now, because beacon 7 is gone"));
        tf.take([](const auto&) {});  // transforms of the first beacon
        CHECK(tf.wait_for([](const auto&) { return true; }));
      }
    }
  }
}

SCENARIO("a description of the robot without the frame of the IMU is named") {
  GIVEN("a relay that waits for the mount of imu_link, and a description that calls it os_imu") {
    const Bus bus;
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--mount-from-tf"});
    const std::string base = "base_link";
    const std::string imu = "os_imu";
    const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
    dds::pub::DataWriter<ros2::TFMessage> robot(
        dds::pub::Publisher(participant), dds::topic::Topic<ros2::TFMessage>(participant, "rt/tf_static"),
        qos_of(Subscription::latched));
    auto transform = ros2::transform({}, clocks::host_now(), base, imu);
    robot.write({{1, 1, &transform, false}});
    const auto bridge = bus.bridge({"--scenario", "walk"});
    THEN("the relay names the frames that there are, and the options") {
      CHECK(
          relay->wait_for_line(Stream::error,
                               "/tf_static does not connect imu_link with base_link, so there are no poses "
                               "(--mount-from-tf): it has os_imu; --base-frame and --imu-frame name others"));
    }
  }
}

}  // namespace sonopose::ros2_tf_test
