#include "recorder/ros2_topics.hpp"

#include "dds/dds_fixture.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sonopose::recorder::test::ros2_topics_test {

SCENARIO("a topic of ROS 2 that DDS refuses does not end the recording") {
  GIVEN("a recording of the topics of ROS 2") {
    const sonopose::test::TemporaryFolder folder;
    Trigger trigger;
    process::Wakeup failed;
    Pipeline pipeline(
        {.series = {.file = folder.path() / "run.mcap", .writer = {}, .channels = {}, .about = {}},
         .queue_bytes = 1U << 20U,
         .last = std::nullopt},
        trigger, failed);
    const auto member = dds::test::participant();
    const dds::qos::Provider qos;
    Ros2Topics topics(pipeline, member, qos);
    WHEN("writers of a good name and of one that Cyclone DDS refuses appear") {
      const auto writer_of = [](const char* topic) {
        dds::FoundEndpoint writer;
        writer.topic_name = topic;
        writer.type_name = "sensor_msgs::msg::dds_::Imu_";
        return writer;
      };
      topics.update({writer_of("rt/foo-bar"), writer_of("rt/imu")});
      THEN("the good one is recorded") {
        CHECK(pipeline.received() == std::map<std::string, std::uint64_t>{{"/imu", 0}});
      }
    }
  }
}

}  // namespace sonopose::recorder::test::ros2_topics_test
