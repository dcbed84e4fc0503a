/// Announcement of a node on `ros_discovery_info`, whose type has two layouts.

#include "support/process.hpp"
#include "support/ros2_graph.hpp"
#include "support/test_domain.hpp"
#include <sonopose/ros2/messages/type_hash.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

namespace sonopose::node_test {

using namespace test;
using Stream = Process::Stream;

template <class Info>
std::unique_ptr<Process> start_node(std::uint32_t domain_id) {
  const bool humble = std::is_same_v<Info, ros2::HumbleParticipantEntitiesInfo>;
  return std::make_unique<Process>(
      SONOPOSE_TEST_ROS2_NODE,
      std::vector<std::string>{std::to_string(domain_id), humble ? "humble" : "jazzy"});
}

TEMPLATE_TEST_CASE("A node announces its readers and writers, and withdraws them when it ends", "",
                   ros2::HumbleParticipantEntitiesInfo, ros2::ParticipantEntitiesInfo) {
  ::unsetenv("CYCLONEDDS_URI");
  const TestDomain domain;
  const bool late = GENERATE(false, true);
  CAPTURE(late);
  auto node = start_node<TestType>(domain.id());
  if (late) REQUIRE(node->wait_for_line(Stream::output, "ready"));
  Watcher<TestType> watcher(domain.id());
  REQUIRE(watcher.wait_for_count(1));

  const GraphInfo info = watcher.messages.back();
  const dds::Discovery discovery(watcher.participant());
  const auto participants = discovery.participants();
  const auto participant = std::find_if(participants.begin(), participants.end(),
                                        [&](const auto& each) { return each.key == info.participant; });
  REQUIRE(participant != participants.end());
  CHECK(text_of(participant->user_data) == "enclave=/;");

  REQUIRE(info.nodes.size() == 1);
  CHECK(info.nodes[0].name_space == "/hall");
  CHECK(info.nodes[0].name == "locator");
  // Announced endpoints may be discovered a little later.
  std::map<std::string, dds::FoundEndpoint> writers;
  std::map<std::string, dds::FoundEndpoint> readers;
  REQUIRE(watcher.wait_until([&] {
    writers = endpoints_of(discovery.writers(), info.participant);
    readers = endpoints_of(discovery.readers(), info.participant);
    return writers.size() >= 3 && !readers.empty();
  }));
  const auto& imu = writers.at("rt/hall/imu/data");
  const auto& fix = readers.at("rt/hall/locator/fix_in");
  CHECK(info.nodes[0].writers == std::set<std::string>{imu.key, writers.at("rt/tf_static").key});
  CHECK(info.nodes[0].readers == std::set<std::string>{fix.key});
  CHECK(imu.type_name == "sensor_msgs::msg::dds_::Imu_");
  CHECK(fix.type_name == "geometry_msgs::msg::dds_::PointStamped_");
  CHECK(user_data_of(imu) == "typehash=" + ros2::type_hash(imu.type_name) + ";");
  CHECK(user_data_of(fix) == "typehash=" + ros2::type_hash(fix.type_name) + ";");
  CHECK(writers.at("ros_discovery_info").type_name == "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");

  CHECK(node->end_by(SIGTERM).code == 0);
  CHECK(watcher.wait_until([&] { return watcher.messages.back().nodes.empty(); }));
  CHECK(watcher.wait_until([&] { return watcher.writer_count() == 0; }));
}

TEST_CASE("A node announces only changes") {
  ::unsetenv("CYCLONEDDS_URI");
  const TestDomain domain;
  Watcher<ros2::ParticipantEntitiesInfo> watcher(domain.id());
  const dds::qos::Provider qos;
  ros2::Node node(watcher.participant(), qos, ros2::NameResolver({}), ros2::Distro::jazzy);
  node.announce();
  node.announce();
  auto imu = node.make_writer<ros2::Imu>("imu", "ros2::Default");
  const std::string key = dds::ext::text_of(dds::ext::guid_of(imu));
  node.announce();
  node.remove(imu);
  imu.close();
  node.announce();
  REQUIRE(watcher.wait_for_count(3));
  REQUIRE(watcher.messages.size() == 3);
  CHECK(watcher.messages[0].nodes.at(0).writers.empty());
  CHECK(watcher.messages[0].nodes.at(0).name == "sonopose");
  CHECK(watcher.messages[1].nodes.at(0).writers == std::set<std::string>{key});
  CHECK(watcher.messages[2].nodes.at(0).writers.empty());
}

TEST_CASE("A partition in a profile of ROS 2 is that of its endpoints") {
  ::unsetenv("CYCLONEDDS_URI");
  const TestDomain domain;
  const auto participant = dds::ext::participant({.domain_id = domain.id()});
  const std::string partition = "<partition><name><element>hall</element></name></partition>";
  dds::qos::Provider qos;
  qos.merge(R"(<dds><qos_library name="ros2"><qos_profile name="Default"><datawriter_qos>)" + partition +
                "</datawriter_qos><datareader_qos>" + partition +
                "</datareader_qos></qos_profile></qos_library></dds>",
            "user.xml");
  ros2::Node node(participant, qos, ros2::NameResolver({}), ros2::Distro::jazzy);
  const dds::core::StringSeq expected{"hall"};
  const auto writer = node.make_writer<ros2::Imu>("imu", "ros2::Default");
  const auto reader = node.make_reader<ros2::Imu>("imu", "ros2::Default");
  CHECK(writer.publisher().qos().policy<dds::policy::Partition>().name() == expected);
  CHECK(reader.subscriber().qos().policy<dds::policy::Partition>().name() == expected);
}

}  // namespace sonopose::node_test
