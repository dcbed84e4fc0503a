#include "recorder/ros2_topics.hpp"

#include "dds/dds_fixture.hpp"
#include "support/matches.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace sonopose::recorder::test::ros2_topics_test {

/// A recording of the topics of ROS 2.
struct Recording {
  /// Announces a writer to the recorder.
  void find(const std::string& topic, const std::string& type) {
    dds::FoundEndpoint writer;
    writer.topic_name = topic;
    writer.type_name = type;
    topics.update({writer});
  }

  sonopose::test::TemporaryFolder folder;
  Trigger trigger;
  process::Wakeup failed;
  Pipeline pipeline{
      {.series = {.file = folder.path() / "run.mcap", .writer = {}, .channels = {}, .about = {}},
       .queue_bytes = 1U << 20U,
       .last = std::nullopt},
      trigger,
      failed};
  dds::domain::DomainParticipant member = dds::test::participant();
  dds::qos::Provider qos;
  Ros2Topics topics{pipeline, member, qos};
};

SCENARIO("a topic of ROS 2 that DDS refuses does not end the recording") {
  Recording recording;
  WHEN("writers of a good name and of one that Cyclone DDS refuses appear") {
    recording.find("rt/foo-bar", "sensor_msgs::msg::dds_::Imu_");
    recording.find("rt/imu", "sensor_msgs::msg::dds_::Imu_");
    THEN("the good one is recorded") {
      CHECK(recording.pipeline.received() == std::map<std::string, std::uint64_t>{{"/imu", 0}});
    }
  }
}

/// Types of the messages that the headers declare as those of topics, by their names in DDS; without those of
/// the discovery.
std::set<std::string> message_types() {
  std::set<std::string> types;
  for (const char* const header : {"idl_types.hpp", "service_types.hpp"}) {
    const std::string text = sonopose::test::read_text(std::filesystem::path(SONOPOSE_SOURCE_DIR) /
                                                       "include/sonopose/ros2/messages" / header);
    for (const auto& groups :
         sonopose::test::all_matches(text, R"(SONOPOSE_TOPIC_TYPE\((\w+)_msg_dds__(\w+)\))")) {
      if (groups[1] != "rmw_dds_common") types.insert(groups[1] + "::msg::dds_::" + groups[2]);
    }
  }
  return types;
}

SCENARIO("what the relay reads or writes is recorded") {
  Recording recording;
  const auto types = message_types();
  CHECK(types.contains("px4_msgs::msg::dds_::VehicleOdometry_"));
  CHECK(types.contains("rcl_interfaces::msg::dds_::Log_"));
  for (const std::string& type : types) {
    CAPTURE(type);
    const std::string topic = "rt/of_" + type.substr(type.rfind(':') + 1);
    recording.find(topic, type);
    CHECK(recording.topics.contains(topic));
  }
}

}  // namespace sonopose::recorder::test::ros2_topics_test
