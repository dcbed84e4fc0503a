/// Another vendor's DDS hears us, and we hear it: bit for bit, from process to process.

#include "support/bus.hpp"
#include "support/ros2_fields.hpp"

#include <algorithm>
#include <map>

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

namespace {

std::unique_ptr<Process> peer(const Bus& bus, const Arguments& arguments) {
  const Environment environment{{"ROS_DOMAIN_ID", std::to_string(bus.domain_id())}};
  return std::make_unique<Process>(SONOPOSE_TEST_FASTDDS_PEER, arguments, environment);
}

/// A peer that prints so many samples of a topic.
std::unique_ptr<Process> listener(const Bus& bus, const std::string& topic, const std::string& type,
                                  std::size_t count, const Arguments& more = {"--bits"}) {
  Arguments arguments{"listen", topic, type, std::to_string(count)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  auto process = peer(bus, arguments);
  REQUIRE(process->wait_for_line(Stream::error, "listening"));
  return process;
}

dds::Qos reliable_qos() {
  return dds::Qos() << dds::policy::Reliability::reliable() << dds::policy::History::keep_last(10);
}

/// One end in this process, as ROS 2 makes them.
template <template <class> class End, class Message>
struct Own {
  Own(const Bus& bus, const std::string& topic)
      : participant(dds::make_participant({.domain_id = bus.domain_id()})),
        end(participant, dds::Topic<Message>(participant, topic), reliable_qos()) {}

  dds::DomainParticipant participant;
  End<Message> end;
};

/// What a peer that listens prints of a message that we write.
template <class Message>
void check_heard(const std::string& type, const std::vector<std::uint32_t>& lengths,
                 const Arguments& more = {"--bits"}) {
  const Bus bus;
  Own<dds::DataWriter, Message> own(bus, "rt/sent");
  const auto heard = listener(bus, "rt/sent", type, 1, more);
  REQUIRE(wait_for_status(own.end, dds::StatusMask::publication_matched(),
                          [&] { return own.end.publication_matched_status().current_count == 1; }));
  const Filled<Message> filled{Filler(lengths)};
  own.end.write(filled.message);
  REQUIRE(heard->wait_for_exit() == 0);
  REQUIRE(heard->lines(Stream::output).size() == 1);
  CHECK((heard->lines(Stream::output).front() == described(filled.message)));
}

/// Not numbers that have something to say, -0, the least and the most there is, and an ordinary one.
const Arguments awkward{"7ff8dead0000beef", "fff8000000000123", "8000000000000000", "0000000000000001",
                        "7fefffffffffffff", "c0091eb851eb851f", "3fd5555555555555"};

/// A peer's line: what stands between spaces.
using Fields = std::vector<std::string>;
Fields fields_of(const std::string& line) {
  std::istringstream in(line);
  Fields fields;
  for (std::string field; in >> field;) fields.push_back(field);
  return fields;
}

/// The time that begins at this field.
TimeNs time_of(const Fields& fields, std::size_t first = 0) {
  return std::stoll(fields.at(first)) * 1'000'000'000 + std::stoll(fields.at(first + 1));
}

/// The numbers from this field on. Zero has no sign here: what is turned by nothing may lose it.
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

/// Compares each line of a peer with the native sample of the same time, which stands at the field
/// `time_at`. A busy machine may lose a few of the one or the other.
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
  CHECK(compared > 90);
}

}  // namespace

TEST_CASE("Fast DDS hears what we write as ROS 2's messages") {
  check_heard<ros2::Imu>("imu", {0});
  check_heard<ros2::Odometry>("odometry", {0});
  for (const std::uint32_t length : {0U, 1U, 400U}) check_heard<ros2::TFMessage>("tf", {length});
  for (const auto& lengths : {std::vector<std::uint32_t>{0}, {3, 0, 1, 5}, {40, 9, 0}}) {
    check_heard<ros2::DiagnosticArray>("diagnostics", lengths);
  }
}

TEST_CASE("Our reliable writers reach Fast DDS readers of sensor data too") {
  const Bus bus;
  Own<dds::DataWriter, ros2::Imu> own(bus, "rt/sent");
  const Filled<ros2::Imu> filled;
  const auto heard = listener(bus, "rt/sent", "imu", 1, {"--bits", "--best-effort"});
  // What comes before it has found us is not sent again.
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (!heard->wait_for_lines(Stream::output, 1, std::chrono::milliseconds(10))) {
    REQUIRE(std::chrono::steady_clock::now() < give_up);
    own.end.write(filled.message);
  }
  CHECK(heard->lines(Stream::output).front() == described(filled.message));
}

TEST_CASE("We hear what Fast DDS writes as ROS 2's messages") {
  const Bus bus;
  Own<dds::DataReader, ros2::Imu> own(bus, "rt/sent");
  Arguments arguments{"send-imu", "rt/sent", "7"};
  arguments.insert(arguments.end(), awkward.begin(), awkward.end());
  const auto sender = peer(bus, arguments);
  std::vector<std::string> heard;
  REQUIRE(wait_for_status(own.end, dds::StatusMask::data_available(), [&] {
    own.end.take_each([&](const ros2::Imu& imu, const dds::SampleInfo&) { heard.push_back(described(imu)); });
    return heard.size() == 7;
  }));
  REQUIRE(sender->wait_for_exit() == 0);
  CHECK(heard == sender->lines(Stream::output));
  for (std::size_t i = 0; i < awkward.size(); ++i) {
    CHECK(fields_of(heard.front()).at(3 + i) == awkward[i]);
  }
}

SCENARIO("consumers in Fast DDS get of the relay what native ones get") {
  GIVEN("a beacon, its fusion, the relay, and consumers of both kinds") {
    const Bus bus;
    Consumer<sonopose_FusedPose> pose(bus, topics::pose);
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto odometry = listener(bus, "rt/hedge_7/odom", "odometry", 100);
    const auto raw_imu = listener(bus, "rt/hedge_7/imu/data_raw", "imu", 100, {"--bits", "--best-effort"});
    const auto tf = listener(bus, "rt/tf", "tf", 100);
    const auto diagnostics = listener(bus, "rt/diagnostics", "diagnostics", 4);
    Process relay(SONOPOSE_TEST_ROS2, {"--domain", std::to_string(bus.domain_id())});
    REQUIRE(relay.wait_for_line(Stream::error, "relaying"));
    const auto fusion = bus.fusion();
    WHEN("the beacon moves") {
      const auto bridge = bus.bridge({});
      for (const auto* const heard : {&odometry, &raw_imu, &tf, &diagnostics}) {
        REQUIRE((*heard)->wait_for_exit() == 0);
      }
      pose.take();
      imu.take();
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
          REQUIRE(fields.at(7) == "bff0000000000000");  // -1: a raw sample knows no orientation
          REQUIRE(numbers<3>(fields, 16) == numbers(native.angular_velocity_body_radps));
          REQUIRE(numbers<3>(fields, 28) == numbers(native.specific_force_body_mps2));
        });
        compare(*tf, poses, 1, [](const Fields& fields, const FusedPose& native) {
          REQUIRE(fields.at(3) == "\"map\"");
          REQUIRE(fields.at(4) == "\"base_link\"");
          REQUIRE(numbers<3>(fields, 5) == numbers(native.position_world_m));
          REQUIRE(numbers<4>(fields, 8) == numbers(native.q_body_to_world));
        });
        const std::string last = diagnostics->lines(Stream::output).back();
        CHECK(last.find("[1]") != std::string::npos);
        CHECK(last.find(": beacon 7\"") != std::string::npos);
      }
    }
  }
}

SCENARIO("the relay takes the samples of a driver in Fast DDS in") {
  GIVEN("a relay with an input, and a native consumer") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    Process relay(SONOPOSE_TEST_ROS2,
                  {"--imu-in", "/driver/imu=9", "--domain", std::to_string(bus.domain_id())});
    REQUIRE(relay.wait_for_line(Stream::error, "relaying"));
    REQUIRE(imu.wait_for_writers());
    WHEN("the driver sends 50 samples") {
      Arguments arguments{"send-imu", "rt/driver/imu", "50"};
      arguments.insert(arguments.end(), awkward.begin() + 2, awkward.end());  // finite ones alone are taken
      const auto driver = peer(bus, arguments);
      REQUIRE(driver->wait_for_exit() == 0);
      const auto sent = driver->lines(Stream::output);
      REQUIRE(sent.size() == 50);
      THEN(
          "the consumer gets them as that beacon's, bit for bit, from the time on when all know each other") {
        REQUIRE(imu.wait_for([&](const ImuSample& sample) {
          return sample.sensor_time_ns == time_of(fields_of(sent.back()));
        }));
        REQUIRE(imu.samples.size() > 25);
        for (std::size_t back = 1; back <= imu.samples.size(); ++back) {
          const ImuSample& native = imu.samples[imu.samples.size() - back];
          const auto fields = fields_of(sent.at(sent.size() - back));
          REQUIRE(native.address == 9);
          REQUIRE(native.sensor_time_ns == time_of(fields));
          for (int i = 0; i < 3; ++i) {
            const auto at = static_cast<std::size_t>(i);
            REQUIRE(std::bit_cast<std::uint64_t>(native.angular_velocity_body_radps[i]) ==
                    std::stoull(fields.at(16 + at), nullptr, 16));
            REQUIRE(std::bit_cast<std::uint64_t>(native.specific_force_body_mps2[i]) ==
                    std::stoull(fields.at(28 + at), nullptr, 16));
          }
        }
      }
    }
  }
}
