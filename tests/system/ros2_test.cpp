/// The relay's messages, as received by a ROS 2 process, compared with the native topics.

#include "support/ros2.hpp"

#include "support/wait_until.hpp"
#include <sonopose/dds/psm/discovery.hpp>

#include <algorithm>
#include <csignal>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::ros2_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Waits for a message and the native sample of the same time; a busy machine may lose a few of either.
/// `messages` holds the relevant part of each message by its stamp.
template <class Message, class Seen, class T, class Time>
auto wait_for_pair(RosReader<Message>& reader, std::map<TimeNs, Seen>& messages, Consumer<T>& natives,
                   Time time) {
  std::optional<std::pair<Seen, typename Consumer<T>::Sample>> pair;
  REQUIRE(wait_until([&] {
    reader.take([&](const Message& message) { messages.emplace(stamp_of(message.header), message); });
    natives.take();
    for (const auto& sample : natives.samples) {
      const auto found = messages.find(sample.*time);
      if (found != messages.end()) pair.emplace(found->second, sample);
    }
    return pair.has_value();
  }));
  return *pair;
}
template <class Message, class T, class Time>
auto wait_for_pair(RosReader<Message>& reader, Consumer<T>& natives, Time time) {
  std::map<TimeNs, Message> messages;
  return wait_for_pair(reader, messages, natives, time);
}

template <std::size_t size>
bool positive_diagonal(const double (&covariance)[size], std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(covariance[i * (rows + 1)] > 0)) return false;
  }
  return true;
}

/// A copy of the tested fields: a loaned message is valid only for a short time.
struct SeenOdometry {
  explicit SeenOdometry(const ros2::Odometry& message);

  Vector3d position_m;
  Quaterniond orientation;
  Vector3d velocity_mps;
  bool variances_positive = false;
  std::string frame;
  std::string child;
};

SeenOdometry::SeenOdometry(const ros2::Odometry& message)
    : position_m(ros2::base_in_map(message).translation_m),
      orientation(ros2::base_in_map(message).rotation),
      velocity_mps(message.twist.twist.linear.x, message.twist.twist.linear.y, message.twist.twist.linear.z),
      variances_positive(positive_diagonal(message.pose.covariance, 6) &&
                         positive_diagonal(message.twist.covariance, 6)),
      frame(message.header.frame_id),
      child(message.child_frame_id) {}

SCENARIO("a ROS 2 process receives the fused pose as Odometry, bit for bit") {
  GIVEN("a running chain, a relay, a default subscription and a sensor-data subscription") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    RosReader<ros2::Odometry> standard(bus, "/hedge_7/odom");
    RosReader<ros2::Odometry> sensor_data(bus, "/hedge_7/odom", Subscription::sensor_data);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2();
    const auto bridge = bus.bridge({"--scenario", "walk"});
    THEN("both receive the native pose of the same time, with the velocity in body axes") {
      std::vector<TimeNs> stamps_ns;
      std::map<TimeNs, SeenOdometry> messages;
      REQUIRE(standard.wait_for_count(50, [&](const auto& message) {
        stamps_ns.push_back(stamp_of(message.header));
        messages.emplace(stamps_ns.back(), message);
      }));
      CHECK(std::is_sorted(stamps_ns.begin(), stamps_ns.end(), std::less_equal<>()));
      const auto [odometry, pose] = wait_for_pair(standard, messages, poses, &FusedPose::time_ns);
      CHECK(odometry.position_m == pose.position_world_m);
      CHECK(odometry.orientation.coeffs() == pose.q_body_to_world.coeffs());
      CHECK((pose.q_body_to_world * odometry.velocity_mps - pose.velocity_world_mps).norm() < 1e-9);
      CHECK(odometry.frame == "map");
      CHECK(odometry.child == "base_link");
      for (const auto& [stamp_ns, each] : messages) CHECK(each.variances_positive);
      CHECK(sensor_data.wait_for_count(20, [](const auto&) {}));
    }
  }
}

SCENARIO("a ROS 2 process receives the IMU, raw and with orientation, and the fixes") {
  GIVEN("a running chain and a relay") {
    const Bus bus;
    Consumer<sonopose_ImuSample> samples(bus, topics::imu);
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
    RosReader<ros2::Imu> raw(bus, "/hedge_7/imu/data_raw", Subscription::sensor_data);
    RosReader<ros2::Imu> fused(bus, "/hedge_7/imu/data", Subscription::sensor_data);
    RosReader<ros2::PoseWithCovarianceStamped> fix(bus, "/hedge_7/fix");
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2();
    const auto bridge = bus.bridge({"--scenario", "walk"});
    THEN("each message equals the native sample of the same time") {
      const auto [of_raw, raw_sample] = wait_for_pair(raw, samples, &ImuSample::sensor_time_ns);
      CHECK(of_raw.linear_acceleration.x == raw_sample.specific_force_body_mps2.x());
      CHECK(of_raw.linear_acceleration.z == raw_sample.specific_force_body_mps2.z());
      CHECK(of_raw.angular_velocity.y == raw_sample.angular_velocity_body_radps.y());
      CHECK(of_raw.orientation_covariance[0] == -1);  // no orientation
      const auto [of_sample, sample] = wait_for_pair(fused, samples, &ImuSample::sensor_time_ns);
      CHECK(of_sample.linear_acceleration.z == sample.specific_force_body_mps2.z());
      const auto [of_pose, pose] = wait_for_pair(fused, poses, &FusedPose::imu_sensor_time_ns);
      CHECK(of_pose.orientation.w == pose.q_body_to_world.w());
      CHECK(of_pose.orientation.z == pose.q_body_to_world.z());
      CHECK(positive_diagonal(of_pose.orientation_covariance, 3));
      const auto [of_fix, native] = wait_for_pair(fix, fixes, &UltrasonicFix::emission_time_ns);
      CHECK(of_fix.pose.pose.position.x == native.position_world_m.x());
      CHECK(of_fix.pose.pose.position.y == native.position_world_m.y());
      CHECK(positive_diagonal(of_fix.pose.covariance, 6));
    }
  }
}

SCENARIO("imu/data has every sample, also where its pose arrives first") {
  GIVEN("a running chain at 200 Hz, and a relay that starts last, so that it receives last") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    RosReader<ros2::Imu> raw(bus, "/hedge_7/imu/data_raw");
    RosReader<ros2::Imu> fused(bus, "/hedge_7/imu/data");
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--imu-rate", "200"});
    REQUIRE(poses.wait_for_count(1));
    const auto relay = bus.ros2();
    THEN("each of 200 samples as measured has its counterpart with the orientation") {
      std::set<TimeNs> raw_ns;
      std::set<TimeNs> fused_ns;
      // On a busy machine the transport loses some samples, and the count restarts.
      const auto longest_run = [&] {
        int longest = 0;
        int run = 0;
        for (const TimeNs time_ns : raw_ns) {
          run = fused_ns.contains(time_ns) ? run + 1 : 0;
          longest = std::max(longest, run);
        }
        return longest;
      };
      CHECK(wait_until([&] {
        raw.take([&](const auto& imu) { raw_ns.insert(stamp_of(imu.header)); });
        fused.take([&](const auto& imu) { fused_ns.insert(stamp_of(imu.header)); });
        return longest_run() >= 200;
      }));
    }
  }
}

SCENARIO("ROS 2 diagnostics report the state of each beacon") {
  GIVEN("a relay without a beacon") {
    const Bus bus;
    RosReader<ros2::DiagnosticArray> diagnostics(bus, "/diagnostics");
    const auto relay = bus.ros2();
    const auto level_of = [](const ros2::DiagnosticArray& message, const std::string& name) {
      for (std::uint32_t i = 0; i < message.status._length; ++i) {
        if (message.status._buffer[i].name == name) return int{message.status._buffer[i].level};
      }
      return -1;
    };
    WHEN("a chain starts, and later its bridge is killed") {
      const bool was_alone = diagnostics.wait_for(
          [&](const auto& message) { return level_of(message, "sonopose: relay") == 3; });
      const auto fusion = bus.fusion();
      const auto bridge = bus.bridge({});
      const bool was_ok = diagnostics.wait_for(
          [&](const auto& message) { return level_of(message, "sonopose: beacon 7") == 0; });
      bridge->send(SIGKILL);
      THEN("it reports that there is no beacon, then that the beacon is OK, then an error") {
        CHECK(was_alone);
        CHECK(was_ok);
        CHECK(diagnostics.wait_for(
            [&](const auto& message) { return level_of(message, "sonopose: beacon 7") == 2; }));
      }
    }
  }
}

SCENARIO("names, frames and message types are configurable") {
  GIVEN("a relay in a namespace, with a beacon's topics renamed, and fixes as points") {
    const Bus bus;
    RosReader<ros2::Odometry> odom(bus, "/robot/odometry");
    RosReader<ros2::PointStamped> fix(bus, "/robot/tag7/fix");
    RosReader<ros2::Path> path(bus, "/robot/tag7/path");
    const auto fusion = bus.fusion();
    const auto relay =
        bus.ros2({"--namespace", "/robot", "--beacon-namespace", "tag{address}", "--remap",
                  "tag7/odom:=odometry", "--fix-message", "point", "--path", "10", "--map-frame", "hall"});
    const auto bridge = bus.bridge({});
    THEN("the node and the topics exist under these names") {
      CHECK(relay->wait_for_line(Stream::error, "relaying as /robot/sonopose"));
      std::string frame;
      CHECK(odom.wait_for_count(5, [&](const auto& message) { frame = message.header.frame_id; }));
      CHECK(frame == "hall");
      CHECK(fix.wait_for_count(2, [](const auto&) {}));
      CHECK(path.wait_for([](const auto& message) { return message.poses._length > 5; }));
    }
  }
}

SCENARIO("the relay publishes the selected topics at the selected rate") {
  GIVEN("a chain at 100 Hz, and a relay with two topics and 10 Hz") {
    const Bus bus;
    RosReader<ros2::Imu> raw(bus, "/hedge_7/imu/data_raw");
    RosReader<ros2::Odometry> odom(bus, "/hedge_7/odom");
    RosReader<ros2::TFMessage> tf(bus, "/tf");
    const dds::domain::DomainParticipant participant = dds::ext::participant({.domain_id = bus.domain_id()});
    const dds::Discovery discovery(participant);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--topics", "odom,imu/data_raw", "--rate", "10"});
    const auto bridge = bus.bridge({"--imu-rate", "100"});
    THEN("poses and transforms come at 10 Hz, and samples at 100 Hz, without other topics") {
      constexpr std::size_t count = 10;
      const auto stamps_ns = [](auto& reader, const auto& stamp) {
        std::vector<TimeNs> all_ns;
        REQUIRE(reader.wait_for_count(count, [&](const auto& m) { all_ns.push_back(stamp(m)); }));
        return all_ns;
      };
      const auto shortest_gap_s = [](std::vector<TimeNs> all_ns) {
        std::adjacent_difference(all_ns.begin(), all_ns.end(), all_ns.begin());
        return seconds_between(0, *std::min_element(all_ns.begin() + 1, all_ns.end()));
      };
      const auto check_10_hz = [&](const std::vector<TimeNs>& all_ns) {
        CHECK(shortest_gap_s(all_ns) < 0.115);  // if nothing is lost
        // The first one may be late.
        CHECK(seconds_between(all_ns.front(), all_ns.back()) >
              0.099 * static_cast<double>(all_ns.size() - 2));
      };
      const auto of_header = [](const auto& m) { return stamp_of(m.header); };
      check_10_hz(stamps_ns(odom, of_header));
      check_10_hz(stamps_ns(tf, [](const auto& m) { return stamp_of(m.transforms._buffer[0].header); }));
      CHECK(shortest_gap_s(stamps_ns(raw, of_header)) == Approx(0.01).margin(0.002));
      std::set<std::string> topics;
      for (const auto& writer : discovery.writers()) {
        if (writer.topic_name.starts_with("rt/hedge_7/")) topics.insert(writer.topic_name);
      }
      CHECK(topics == std::set<std::string>{"rt/hedge_7/odom", "rt/hedge_7/imu/data_raw"});
    }
  }
}

}  // namespace sonopose::ros2_test
