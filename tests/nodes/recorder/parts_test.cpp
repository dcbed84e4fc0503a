#include "bus_log/instance_end.hpp"
#include "recorder/chunk_queue.hpp"
#include "recorder/foreign_topics.hpp"
#include "recorder/last_seconds.hpp"
#include "recorder/messages.hpp"
#include "recorder/recorder_node.hpp"
#include "recorder/trigger.hpp"
#include <sonopose/idl/sonopose.h>

#include <catch2/catch.hpp>

#include <stdexcept>

namespace sonopose::recorder::test::parts_test {

TEST_CASE("The queue takes what fits, and gives all of it at once") {
  const auto data = command_cdr(7, 1);
  const std::size_t message_bytes = mcap::Chunk::bytes_of(data.size());
  ChunkQueue queue(3 * message_bytes);
  for (std::uint32_t i = 1; i <= 3; ++i) CHECK(queue.add({1, i, std::uint64_t{10} * i, 0, data}));
  CHECK_FALSE(queue.add({1, 4, 40, 0, data}));

  mcap::Chunk chunk = queue.make_chunk();
  queue.exchange(chunk);
  CHECK(chunk.message_count() == 3);
  CHECK(chunk.log_times().end_ns == 30);
  CHECK(queue.add({1, 5, 50, 0, data}));
  queue.exchange(chunk);
  CHECK(chunk.message_count() == 1);
  queue.exchange(chunk);
  CHECK(chunk.is_empty());
}

TEST_CASE("The end of an instance as text") {
  const bus_log::InstanceEnd end{.topic = "sonopose/reset",
                                 .disposed = GENERATE(true, false),
                                 .key_cdr = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{2},
                                             std::byte{7}, std::byte{1}, std::byte{0xAB}, std::byte{0}},
                                 .source_time_ns = 1'600'000'000'000'000'001};
  CHECK(bus_log::instance_end_of(bus_log::json_of(end)) == end);
  CHECK_THAT(bus_log::json_of(end), Catch::Contains(R"("key":{"address":263},"key_cdr":"000100020701ab00")"));
  for (const char* const text :
       {"", "{}", "[]", R"({"topic":"a","kind":"died","key_cdr":"","source_time_ns":0})",
        R"({"topic":"a","kind":"disposed","key_cdr":"0x","source_time_ns":0})",
        R"({"topic":"a","kind":"disposed","key_cdr":"001","source_time_ns":0})",
        R"({"topic":"a","kind":"disposed","key_cdr":"00","source_time_ns":1e300})",
        R"({"topic":1,"kind":"disposed","key_cdr":"00","source_time_ns":0})"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(bus_log::instance_end_of(text), std::invalid_argument);
  }
}

TEST_CASE("The last seconds in memory") {
  const auto data = command_cdr(7, 1);
  const auto chunk_at = [&](std::uint64_t time_ns) {
    mcap::Chunk chunk;
    chunk.add({1, 1, time_ns, 0, data});
    return chunk;
  };
  constexpr std::uint64_t second = 1'000'000'000;
  const auto taken_at = [](std::uint64_t time_s) {
    const SteadyTime end{static_cast<std::int64_t>(time_s * second)};
    return ArrivalSpan{end - 500'000'000, end};
  };
  SECTION("the host's clock may be set meanwhile") {
    LastSeconds last(3 * second, 1U << 20U);
    for (std::uint64_t t = 1; t <= 10; ++t) {
      last.add(chunk_at((t < 8 ? 1000 + t : t) * second),
               taken_at(t));  // steps back by about a thousand seconds
    }
    REQUIRE(last.chunks().size() == 4);
    CHECK(last.chunks().front().chunk.log_times().start_ns == 1007 * second);
  }
  SECTION("older ones are dropped") {
    LastSeconds last(3 * second, 1U << 20U);
    std::vector<std::uint64_t> dropped;
    for (std::uint64_t t = 1; t <= 10; ++t) {
      for (const auto& chunk : last.add(chunk_at(t * second), taken_at(t))) {
        dropped.push_back(chunk.log_times().start_ns / second);
      }
    }
    CHECK(dropped == std::vector<std::uint64_t>{1, 2, 3, 4, 5, 6});
    REQUIRE(last.chunks().size() == 4);
    CHECK(last.chunks().front().chunk.log_times().start_ns == 7 * second);
    CHECK_FALSE(last.is_short());
    last.clear();
    CHECK(last.chunks().empty());
  }
  SECTION("without new ones the old ones are dropped too") {
    LastSeconds last(3 * second, 1U << 20U);
    for (std::uint64_t t = 1; t <= 3; ++t) last.add(chunk_at(t * second), taken_at(t));
    CHECK(last.drop_until(SteadyTime{5 * std::int64_t{second}}).size() == 1);
    CHECK(last.chunks().size() == 2);
    CHECK(last.drop_until(SteadyTime{60 * std::int64_t{second}}).size() == 2);
    CHECK(last.chunks().empty());
  }
  SECTION("the memory has a limit") {
    const std::size_t one = mcap::Chunk::bytes_of(data.size()) + sizeof(mcap::Chunk::Entry);
    LastSeconds last(100 * second, 2 * one);
    for (std::uint64_t t = 1; t <= 10; ++t) last.add(chunk_at(t * second), taken_at(t));
    REQUIRE(last.chunks().size() == 2);
    CHECK(last.chunks().front().chunk.log_times().start_ns == 9 * second);
    CHECK(last.is_short());
    last.add(chunk_at(200 * second), taken_at(200));
    CHECK_FALSE(last.is_short());  // the dropped chunks would be too old by now
  }
}

/// CDR of a pose with only an address and a status. The IDL puts these before the status: 8 bytes of address
/// and padding, two times, 3 + 4 + 4 · 3 + 21 + 6 + 2 doubles, and the reset counter.
std::vector<std::byte> pose_cdr(std::uint16_t address, std::uint32_t status) {
  std::vector<std::byte> bytes = command_cdr(address, 0);
  bytes.resize(4 + 8 + 16 + (3 + 4 + 12 + 21 + 6 + 2) * 8 + 4);
  for (std::size_t i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(status >> (8 * i)));
  bytes.resize(bytes.size() + 32);
  return bytes;
}

TEST_CASE("A status that turns bad is a trigger, once for each time") {
  Trigger trigger;
  BadStatusTrigger poses(trigger);
  CHECK(dds::topics::status_of_pose(pose_cdr(7, 0x01020304)) == 0x01020304);
  CHECK(dds::topics::status_of_pose({}) == 0);
  poses.on_sample(pose_cdr(7, sonopose_STATUS_STALE));
  CHECK(trigger.take() == TriggerCause::none);  // the status was never good
  poses.on_sample(pose_cdr(7, sonopose_STATUS_INITIALISING));
  poses.on_sample(pose_cdr(7, sonopose_STATUS_STALE));
  CHECK(trigger.take() == TriggerCause::none);
  poses.on_sample(pose_cdr(7, sonopose_STATUS_UNCALIBRATED));
  poses.on_sample(pose_cdr(8, sonopose_STATUS_STALE));
  CHECK(trigger.take() == TriggerCause::none);  // another beacon
  poses.on_sample(pose_cdr(7, sonopose_STATUS_IMU_GAP));
  CHECK(trigger.take() == TriggerCause::status);
  poses.on_sample(pose_cdr(7, sonopose_STATUS_STALE));
  CHECK(trigger.take() == TriggerCause::none);  // still bad
  poses.on_sample(pose_cdr(7, sonopose_STATUS_UNCALIBRATED));
  poses.on_sample(pose_cdr(7, sonopose_STATUS_LATE));
  CHECK(trigger.take() == TriggerCause::status);
}

TEST_CASE("The selected topics") {
  const auto names = [](const std::vector<std::string>& wanted, const std::vector<std::string>& excluded) {
    RecorderOptions options;
    options.topics = wanted;
    options.exclude = excluded;
    std::vector<std::string> found;
    for (const auto* const topic : selected_topics(options)) found.emplace_back(topic->name);
    return found;
  };
  CHECK(names({}, {}).size() == dds::topics::serialized_topics().size());
  CHECK(names({"pose", "sonopose/imu", "imu"}, {}) ==
        std::vector<std::string>{"sonopose/imu", "sonopose/pose", "sonopose/settings"});
  CHECK(names({"pose", "imu"}, {"imu", "settings"}) == std::vector<std::string>{"sonopose/pose"});
  CHECK_THROWS_WITH(names({"poses"}, {}), Catch::Contains("poses: unknown topic"));
  CHECK_THROWS_WITH(names({"imu"}, {"imu", "settings"}), Catch::Contains("no topic is left"));
  CHECK_THROWS_WITH(names({"imu"}, {"imu", "imu"}), Catch::Contains("no topic is left"));
  CHECK_THROWS_WITH(names({"imu"}, {"pose"}), Catch::Contains("--exclude: pose is not among --topics"));
}

TEST_CASE("Topics that are not native are named once, with the most writers that they had") {
  const auto writer = [](const std::string& topic, const std::string& type) {
    dds::FoundEndpoint endpoint;
    endpoint.topic_name = topic;
    endpoint.type_name = type;
    return endpoint;
  };
  ForeignTopics foreign;
  const auto imu = writer("sonopose/imu", "sonopose::ImuSample");
  const auto odom = writer("rt/odom", "Odometry");
  const std::vector<std::string> of_odom{
      "not recorded: rt/odom (Odometry), whose type this program does not know"};
  CHECK(foreign.update({imu, odom, odom}, true) == of_odom);
  CHECK(foreign.update({imu, odom}, true).empty());
  const std::vector<std::string> of_imu{
      "not recorded: sonopose/imu (Other), which has another type in this version"};
  CHECK(foreign.update({writer("sonopose/imu", "Other")}, true) == of_imu);
  CHECK(foreign.writer_counts() == std::map<std::string, std::size_t>{{"rt/odom", 2}, {"sonopose/imu", 1}});
  CHECK(foreign.unnamed() == 0);
}

TEST_CASE("A recording without ROS 2 says in one line that it leaves out the topics of ROS 2") {
  std::vector<dds::FoundEndpoint> writers;
  for (const char* const topic : {"ros_discovery_info", "rr/node/resetReply", "rt/odom", "rt/tf"}) {
    writers.emplace_back().topic_name = topic;
  }
  ForeignTopics foreign;
  CHECK(foreign.update(writers, false) ==
        std::vector<std::string>{"not recorded: 4 topics of ROS 2, such as rt/tf; --ros2 records them"});
  CHECK(foreign.writer_counts().size() == 4);
}

TEST_CASE("A bus with any number of other topics does not fill the memory or the end of a file") {
  std::vector<dds::FoundEndpoint> writers(1000);
  for (std::size_t i = 0; i < writers.size(); ++i) writers[i].topic_name = "rt/topic_" + std::to_string(i);
  ForeignTopics foreign;
  CHECK(foreign.update(writers, true).size() == 200);
  CHECK(foreign.update(writers, true).empty());
  CHECK(foreign.writer_counts().size() == 200);
  CHECK(foreign.unnamed() == 800);
}

}  // namespace sonopose::recorder::test::parts_test
