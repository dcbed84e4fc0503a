/// The relay's messages, as received by a ROS 2 process, against the native topics.

#include "support/ros2.hpp"

#include <sonopose/dds/binding/discovery.hpp>

#include <csignal>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace ros2_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

/// Finds the native sample with this stamp; waits for it if necessary.
template <class T, class Time>
auto native_at(Consumer<T>& consumer, TimeNs time_ns, Time time) {
  const auto* found = static_cast<const typename Consumer<T>::Sample*>(nullptr);
  REQUIRE(consumer.wait_for([&](const auto& sample) {
    if (sample.*time == time_ns) found = &sample;
    return found != nullptr;
  }));
  return *found;
}

template <std::size_t size>
bool positive_diagonal(const double (&covariance)[size], std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(covariance[i * (rows + 1)] > 0)) return false;
  }
  return true;
}

/// A copy of the fields under test: a loaned message is only valid for a short time.
struct SeenOdometry {
  TimeNs stamp_ns = 0;
  Vector3d position_m;
  Quaterniond orientation;
  Vector3d velocity_mps;
  bool variances_positive = false;
  std::string frame;
  std::string child;
};

SeenOdometry seen(const ros2::Odometry& message) {
  const ros2::Transform pose = ros2::base_in_map(message);
  const ros2::Vector3& v = message.twist.twist.linear;
  return {stamp_of(message.header),
          pose.translation_m,
          pose.rotation,
          {v.x, v.y, v.z},
          positive_diagonal(message.pose.covariance, 6) && positive_diagonal(message.twist.covariance, 6),
          message.header.frame_id,
          message.child_frame_id};
}

SCENARIO("a ROS 2 process receives the fused pose as Odometry, bit for bit") {
  GIVEN("a running chain, a relay, a default subscription and a sensor-data subscription") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    RosReader<ros2::Odometry> standard(bus, "/hedge_7/odom");
    RosReader<ros2::Odometry> sensor_data(bus, "/hedge_7/odom", Subscription::sensor_data);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2();
    const auto bridge = bus.bridge({"--scenario", "walk"});
    THEN("it is the native pose of the same time, with the velocity in body axes") {
      std::vector<SeenOdometry> odometry;
      REQUIRE(standard.wait_for_count(200, [&](const auto& message) { odometry.push_back(seen(message)); }));
      const FusedPose pose = native_at(poses, odometry.back().stamp_ns, &FusedPose::time_ns);
      CHECK(odometry.back().position_m == pose.position_world_m);
      CHECK(odometry.back().orientation.coeffs() == pose.q_body_to_world.coeffs());
      CHECK((pose.q_body_to_world * odometry.back().velocity_mps - pose.velocity_world_mps).norm() < 1e-9);
      CHECK(odometry.back().frame == "map");
      CHECK(odometry.back().child == "base_link");
      for (std::size_t i = 1; i < odometry.size(); ++i) {
        CHECK(odometry[i].stamp_ns > odometry[i - 1].stamp_ns);
        CHECK(odometry[i].variances_positive);
      }
    }
    THEN("the sensor-data subscription receives it too") {
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
    THEN("the raw IMU message equals the native sample and has no orientation") {
      ros2::Imu message{};
      REQUIRE(raw.wait_for_count(50, [&](const auto& imu) { message = imu; }));
      const ImuSample sample = native_at(samples, stamp_of(message.header), &ImuSample::sensor_time_ns);
      CHECK(message.linear_acceleration.x == sample.specific_force_body_mps2.x());
      CHECK(message.linear_acceleration.z == sample.specific_force_body_mps2.z());
      CHECK(message.angular_velocity.y == sample.angular_velocity_body_radps.y());
      CHECK(message.orientation_covariance[0] == -1);
    }
    THEN("the other message has the fused orientation of the same sample") {
      ros2::Imu message{};
      REQUIRE(fused.wait_for_count(50, [&](const auto& imu) { message = imu; }));
      const FusedPose pose = native_at(poses, stamp_of(message.header), &FusedPose::imu_sensor_time_ns);
      const ImuSample sample = native_at(samples, stamp_of(message.header), &ImuSample::sensor_time_ns);
      CHECK(message.orientation.w == pose.q_body_to_world.w());
      CHECK(message.orientation.z == pose.q_body_to_world.z());
      CHECK(message.linear_acceleration.z == sample.specific_force_body_mps2.z());
      CHECK(positive_diagonal(message.orientation_covariance, 3));
    }
    THEN("a fix has the measured position, the emission time, and the variance of its weight") {
      ros2::PoseWithCovarianceStamped message{};
      REQUIRE(fix.wait_for_count(5, [&](const auto& one) { message = one; }));
      const UltrasonicFix native =
          native_at(fixes, stamp_of(message.header), &UltrasonicFix::emission_time_ns);
      CHECK(message.pose.pose.position.x == native.position_world_m.x());
      CHECK(message.pose.pose.position.y == native.position_world_m.y());
      CHECK(positive_diagonal(message.pose.covariance, 6));
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
    REQUIRE(poses.wait_for_count(200));
    const auto relay = bus.ros2();
    THEN("each sample as measured has its counterpart with the orientation") {
      std::set<TimeNs> fused_ns;
      REQUIRE(fused.wait_for_count(1000, [&](const auto& imu) { fused_ns.insert(stamp_of(imu.header)); }));
      std::set<TimeNs> raw_ns;
      const TimeNs last_ns = *fused_ns.rbegin();
      REQUIRE(raw.wait_for([&](const auto& imu) {
        raw_ns.insert(stamp_of(imu.header));
        return stamp_of(imu.header) >= last_ns;
      }));
      int missing = 0;
      for (const TimeNs time_ns : raw_ns) {
        if (time_ns > *fused_ns.begin() && time_ns < last_ns && !fused_ns.contains(time_ns)) ++missing;
      }
      CHECK(missing == 0);
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
    THEN("it reports that") {
      CHECK(diagnostics.wait_for(
          [&](const auto& message) { return level_of(message, "sonopose: relay") == 3; }));
    }
    WHEN("a chain starts, and later its bridge is killed") {
      const auto fusion = bus.fusion();
      const auto bridge = bus.bridge({});
      THEN("the beacon is OK, then an error") {
        REQUIRE(diagnostics.wait_for(
            [&](const auto& message) { return level_of(message, "sonopose: beacon 7") == 0; }));
        bridge->send(SIGKILL);
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
    CHECK(relay->wait_for_line(Stream::error, "relaying as /robot/sonopose"));
    const auto bridge = bus.bridge({});
    THEN("the topics exist under these names") {
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
    const dds::DomainParticipant participant = dds::make_participant({.domain_id = bus.domain_id()});
    const dds::Discovery discovery(participant);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--topics", "odom,imu/data_raw", "--rate", "10"});
    const auto bridge = bus.bridge({"--imu-rate", "100"});
    const auto seconds_of = [](const std::vector<TimeNs>& stamps) {
      return seconds_between(stamps.front(), stamps.back());
    };
    THEN("poses and transforms come at 10 Hz, and samples at 100 Hz") {
      std::vector<TimeNs> stamps;
      REQUIRE(odom.wait_for_count(21, [&](const auto& m) { stamps.push_back(stamp_of(m.header)); }));
      CHECK(seconds_of(stamps) == Approx(0.1 * static_cast<double>(stamps.size() - 1)).epsilon(0.1));
      stamps.clear();
      REQUIRE(tf.wait_for_count(
          11, [&](const auto& m) { stamps.push_back(stamp_of(m.transforms._buffer[0].header)); }));
      CHECK(seconds_of(stamps) == Approx(0.1 * static_cast<double>(stamps.size() - 1)).epsilon(0.1));
      stamps.clear();
      REQUIRE(raw.wait_for_count(101, [&](const auto& m) { stamps.push_back(stamp_of(m.header)); }));
      CHECK(seconds_of(stamps) == Approx(0.01 * static_cast<double>(stamps.size() - 1)).epsilon(0.1));
    }
    THEN("there are no other topics of the beacon") {
      REQUIRE(odom.wait_for_count(5, [](const auto&) {}));
      std::set<std::string> topics;
      for (const auto& writer : discovery.writers()) {
        if (writer.topic_name.starts_with("rt/hedge_7/")) topics.insert(writer.topic_name);
      }
      CHECK(topics == std::set<std::string>{"rt/hedge_7/odom", "rt/hedge_7/imu/data_raw"});
    }
  }
}

}  // namespace ros2_test
