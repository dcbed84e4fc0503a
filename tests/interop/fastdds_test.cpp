/// Interoperation with another vendor's DDS between processes, in both directions, bit for bit.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"
#include "support/ros2_fields.hpp"
#include "support/wait_until.hpp"

#include <algorithm>
#include <map>

namespace sonopose::fastdds_test {

using namespace sonopose::test;
namespace topics = dds::topics;

std::unique_ptr<Process> peer(const Bus& bus, const Arguments& arguments) {
  const Environment environment{{"ROS_DOMAIN_ID", std::to_string(bus.domain_id())}};
  return std::make_unique<Process>(SONOPOSE_TEST_FASTDDS_PEER, arguments, environment);
}

/// A peer that prints `count` samples of a topic.
std::unique_ptr<Process> listener(const Bus& bus, const std::string& topic, const std::string& type,
                                  std::size_t count, const Arguments& more = {"--bits"}) {
  Arguments arguments{"listen", topic, type, std::to_string(count)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  auto process = peer(bus, arguments);
  REQUIRE(process->wait_for_line(Stream::error, "listening"));
  return process;
}

/// A peer that writes messages of these numbers until it is killed.
std::unique_ptr<Process> driver(const Bus& bus, const std::string& topic, const std::string& type,
                                const Arguments& bits) {
  Arguments arguments{"send", topic, type, "1000000"};
  arguments.insert(arguments.end(), bits.begin(), bits.end());
  return peer(bus, arguments);
}

/// Checks that a peer prints our message bit for bit.
template <class Message>
void check_heard(const std::string& type, const std::vector<std::uint32_t>& lengths) {
  const Bus bus;
  RosWriter<Message> writer(bus, "/sent");
  const auto received = listener(bus, "rt/sent", type, 1);
  REQUIRE(writer.wait_for_reader());
  const Filled<Message> filled{Filler(lengths)};
  writer.write(filled.message);
  REQUIRE(received->wait_for_exit() == 0);
  REQUIRE(received->lines(Stream::output).size() == 1);
  CHECK((received->lines(Stream::output).front() == described(filled.message)));
}

/// NaNs with a payload, -0, the smallest and the largest finite number, and ordinary numbers.
const Arguments awkward{"7ff8dead0000beef", "fff8000000000123", "8000000000000000", "0000000000000001",
                        "7fefffffffffffff", "c0091eb851eb851f", "3fd5555555555555"};

/// A peer's line, split at spaces.
using Fields = std::vector<std::string>;
Fields fields_of(const std::string& line) {
  std::istringstream in(line);
  Fields fields;
  for (std::string field; in >> field;) fields.push_back(field);
  return fields;
}

/// Time in two fields, the first of which is `first`.
TimeNs time_of(const Fields& fields, std::size_t first = 0) {
  return std::stoll(fields.at(first)) * 1'000'000'000 + std::stoll(fields.at(first + 1));
}

/// Numbers from this field on, without the sign of zero, which an identity rotation may lose.
template <std::size_t size>
std::array<double, size> numbers(const Fields& fields, std::size_t first) {
  std::array<double, size> values{};
  for (std::size_t i = 0; i < size; ++i) {
    values[i] = std::bit_cast<double>(std::uint64_t{std::stoull(fields.at(first + i), nullptr, 16)}) + 0.0;
  }
  return values;
}

std::array<double, 3> numbers(const Vector3d& v) {
  return {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0};
}
std::array<double, 4> numbers(const Quaterniond& q) {
  return {q.x() + 0.0, q.y() + 0.0, q.z() + 0.0, q.w() + 0.0};
}

/// Compares each line of a peer with the native sample of the time in field `time_at`. Tolerates lines and
/// samples that a busy machine lost.
template <class Sample, class Compare>
void compare(const Process& peer, const std::map<TimeNs, Sample>& natives, std::size_t time_at,
             const Compare& compare_fields) {
  std::size_t compared = 0;
  for (const std::string& line : peer.lines(Stream::output)) {
    const auto fields = fields_of(line);
    const auto native = natives.find(time_of(fields, time_at));
    if (native == natives.end()) continue;
    compare_fields(fields, native->second);
    ++compared;
  }
  CHECK(compared >= 20);
}

TEST_CASE("Fast DDS hears what we write as ROS 2's messages") {
  check_heard<ros2::Imu>("imu", {0});
  check_heard<ros2::Odometry>("odometry", {0});
  for (const std::uint32_t length : {0U, 1U, 400U}) check_heard<ros2::TFMessage>("tf", {length});
  for (const auto& lengths : {std::vector<std::uint32_t>{0}, {3, 0, 1, 5}, {40, 9, 0}}) {
    check_heard<ros2::DiagnosticArray>("diagnostics", lengths);
    check_heard<ros2::ParticipantEntitiesInfo>("discovery", lengths);
  }
  check_heard<ros2::PoseWithCovarianceStamped>("pose", {0});
  check_heard<ros2::PointStamped>("point", {0});
  check_heard<ros2::MagneticField>("mag", {0});
  check_heard<ros2::VehicleOdometry>("px4_odometry", {0});
  for (const std::uint32_t length : {0U, 1U, 100U}) check_heard<ros2::Path>("path", {length});
}

TEST_CASE("Our reliable writers reach Fast DDS readers of sensor data too") {
  const Bus bus;
  RosWriter<ros2::Imu> writer(bus, "/sent");
  const Filled<ros2::Imu> filled;
  const auto received = listener(bus, "rt/sent", "imu", 1, {"--bits", "--best-effort"});
  // Samples written before the peer discovers the writer are not repeated.
  const auto give_up = std::chrono::steady_clock::now() + timeout;
  while (!received->wait_for_lines(Stream::output, 1, std::chrono::milliseconds(10))) {
    REQUIRE(std::chrono::steady_clock::now() < give_up);
    writer.write(filled.message);
  }
  CHECK(received->lines(Stream::output).front() == described(filled.message));
}

/// Checks that we receive a peer's messages bit for bit. Returns the first one.
template <class Message>
std::string check_received(const std::string& type) {
  const Bus bus;
  RosReader<Message> reader(bus, "/sent");
  const auto sender = driver(bus, "rt/sent", type, awkward);
  std::vector<std::string> received;
  REQUIRE(reader.wait_for_count(10, [&](const Message& message) { received.push_back(described(message)); }));
  REQUIRE(sender->wait_for_line(Stream::output, received.back()));
  // Messages sent before discovery are lost, later ones are not.
  const auto sent = sender->lines(Stream::output);
  const auto first = std::find(sent.begin(), sent.end(), received.front());
  REQUIRE(static_cast<std::size_t>(sent.end() - first) >= received.size());
  CHECK(std::equal(received.begin(), received.end(), first));
  return received.front();
}

TEST_CASE("We receive the ROS 2 messages that Fast DDS writes") {
  for (const std::string& line :
       {check_received<ros2::Imu>("imu"), check_received<ros2::PoseWithCovarianceStamped>("pose"),
        check_received<ros2::TFMessage>("tf")}) {
    for (const std::string& bits : awkward) CHECK(line.find(bits) != std::string::npos);
  }
  check_received<ros2::PointStamped>("point");
  check_received<ros2::Clock>("clock");
}

SCENARIO("consumers in Fast DDS receive the same values from the relay as native ones") {
  GIVEN("a beacon, its fusion, the relay, and consumers of both kinds") {
    const Bus bus;
    Consumer<sonopose_FusedPose> pose(bus, topics::pose);
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto odometry = listener(bus, "rt/hedge_7/odom", "odometry", 40);
    const auto raw_imu = listener(bus, "rt/hedge_7/imu/data_raw", "imu", 40, {"--bits", "--best-effort"});
    const auto tf = listener(bus, "rt/tf", "tf", 40);
    const auto diagnostics = listener(bus, "rt/diagnostics", "diagnostics", 1'000'000);
    const auto relay = bus.ros2();
    const auto fusion = bus.fusion();
    WHEN("the beacon moves") {
      const auto bridge = bus.bridge({});
      for (const auto* const received : {&odometry, &raw_imu, &tf}) {
        REQUIRE(wait_until([&] {
          pose.take();
          imu.take();
          return (*received)->wait_for_exit(std::chrono::milliseconds(10)) == 0;
        }));
      }
      std::map<TimeNs, FusedPose> poses;
      for (const FusedPose& sample : pose.samples) poses[sample.time_ns] = sample;
      std::map<TimeNs, ImuSample> samples;
      for (const ImuSample& sample : imu.samples) samples[sample.sensor_time_ns] = sample;
      THEN("poses, IMU samples and transforms are the same numbers at the same times") {
        compare(*odometry, poses, 0, [](const Fields& fields, const FusedPose& native) {
          REQUIRE(fields.at(2) == "\"map\"");
          REQUIRE(fields.at(3) == "\"base_link\"");
          REQUIRE(numbers<3>(fields, 4) == numbers(native.position_world_m));
          REQUIRE(numbers<4>(fields, 7) == numbers(native.q_body_to_world));
          REQUIRE(numbers<3>(fields, 50) == numbers(native.angular_velocity_body_radps));
        });
        compare(*raw_imu, samples, 0, [](const Fields& fields, const ImuSample& native) {
          REQUIRE(fields.at(2) == "\"imu_link\"");
          REQUIRE(fields.at(7) == "bff0000000000000");  // -1: a raw sample has no orientation
          REQUIRE(numbers<3>(fields, 16) == numbers(native.angular_velocity_body_radps));
          REQUIRE(numbers<3>(fields, 28) == numbers(native.specific_force_body_mps2));
        });
        compare(*tf, poses, 1, [](const Fields& fields, const FusedPose& native) {
          REQUIRE(fields.at(3) == "\"map\"");
          REQUIRE(fields.at(4) == "\"base_link\"");
          REQUIRE(numbers<3>(fields, 5) == numbers(native.position_world_m));
          REQUIRE(numbers<4>(fields, 8) == numbers(native.q_body_to_world));
        });
        REQUIRE(diagnostics->wait_for_line(Stream::output, ": beacon 7\""));
        const auto lines = diagnostics->lines(Stream::output);
        CHECK(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
          return line.find("[2]") != std::string::npos && line.find(": beacon 7\"") != std::string::npos;
        }));  // the beacon and the relay
      }
    }
  }
}

SCENARIO("the relay takes the samples of a driver in Fast DDS in") {
  GIVEN("a relay with an input, and a native consumer") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto relay = bus.ros2({"--imu-in", "/driver/imu=9"});
    REQUIRE(imu.wait_for_writers());
    WHEN("the driver sends") {
      const auto sender =
          driver(bus, "rt/driver/imu", "imu", {awkward.begin() + 2, awkward.end()});  // finite numbers only
      REQUIRE(imu.wait_for_count(40));
      THEN("the consumer gets its samples as that beacon's, bit for bit") {
        std::map<TimeNs, ImuSample> samples;
        for (const ImuSample& sample : imu.samples) samples[sample.sensor_time_ns] = sample;
        compare(*sender, samples, 0, [](const Fields& fields, const ImuSample& native) {
          REQUIRE(native.address == 9);
          for (std::size_t i = 0; i < 3; ++i) {
            const auto axis = static_cast<int>(i);
            REQUIRE(std::bit_cast<std::uint64_t>(native.angular_velocity_body_radps[axis]) ==
                    std::stoull(fields.at(16 + i), nullptr, 16));
            REQUIRE(std::bit_cast<std::uint64_t>(native.specific_force_body_mps2[axis]) ==
                    std::stoull(fields.at(28 + i), nullptr, 16));
          }
        });
      }
    }
  }
}

SCENARIO("the relay takes the positions of a driver in Fast DDS") {
  GIVEN("a relay with an input whose type it learns from the driver, and a native consumer") {
    const Bus bus;
    Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
    const auto relay = bus.ros2({"--fix-in", "/driver/tag=9"});
    REQUIRE(fixes.wait_for_writers());
    const std::string type = GENERATE("pose", "point");
    WHEN("the driver sends") {
      const auto sender = driver(bus, "rt/driver/tag", type, {"3fd5555555555555"});  // all values are 1/3
      THEN("the consumer gets its positions as that beacon's fixes") {
        REQUIRE(fixes.wait_for_count(5));
        const UltrasonicFix& fix = fixes.samples.back();
        CHECK(fix.address == 9);
        CHECK(fix.position_world_m == Vector3d::Constant(std::bit_cast<double>(0x3fd5555555555555)));
        CHECK_FALSE(fix.covariance_world_m2);  // equal values everywhere are not positive definite
        CHECK(fix.measured_delay_s.value_or(-1) >= 0);
      }
    }
  }
}

SCENARIO("PX4's agent, which is a Fast DDS, gets the pose of a drone") {
  GIVEN("a drone, a relay for PX4, and a peer that sends PX4's clock") {
    const Bus bus;
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--source", "sim", "--scenario", "drone"});
    const auto relay = bus.ros2({"--px4", "/"});
    const auto clock = driver(bus, "rt/fmu/out/timesync_status", "timesync", {});
    WHEN("it listens as PX4's client does, with best effort") {
      const auto odometry =
          listener(bus, "rt/fmu/in/vehicle_visual_odometry", "px4_odometry", 50, {"--best-effort"});
      THEN("it gets stamped poses") {
        REQUIRE(odometry->wait_for_exit() == 0);
        const auto fields = fields_of(odometry->lines(Stream::output).back());
        REQUIRE(fields.size() == 2 + 1 + 3 + 4 + 1 + 5 * 3 + 2);
        const auto sample_us = std::stoll(fields[1]);
        CHECK(std::llabs(sample_us * 1000 - clocks::host_now()) < 60'000'000'000);
        CHECK(fields[2] == "2");                   // FRD
        CHECK(std::stod(fields[11 + 6 + 1]) > 0);  // variances
      }
    }
  }
}

}  // namespace sonopose::fastdds_test
