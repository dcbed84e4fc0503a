/// The relay in the ROS 2 graph: its node, enclave and endpoints.

#include "support/bus.hpp"
#include "support/ros2_graph.hpp"

#include <csignal>
#include <type_traits>

namespace sonopose::ros2_node_test {

using namespace sonopose::test;

/// Keys of these topics' writers; fewer if some do not exist yet.
std::set<std::string> writers_of(const dds::Discovery& discovery, const std::string& participant,
                                 const std::vector<std::string>& topics) {
  const auto all = endpoints_of(discovery.writers(), participant);
  std::set<std::string> keys;
  for (const std::string& topic : topics) {
    if (const auto found = all.find(topic); found != all.end()) keys.insert(found->second.key);
  }
  return keys;
}

const std::vector<std::string> topics_of_beacon_7{
    "rt/robot/hedge_7/imu/data_raw", "rt/robot/hedge_7/imu/data", "rt/robot/hedge_7/odom",
    "rt/robot/hedge_7/pose",         "rt/robot/hedge_7/fix",      "rt/robot/kart/way"};

TEMPLATE_TEST_CASE("ROS 2 lists the relay as a node with the topics of the beacons that it received", "",
                   ros2::HumbleParticipantEntitiesInfo, ros2::ParticipantEntitiesInfo) {
  const bool humble = std::is_same_v<TestType, ros2::HumbleParticipantEntitiesInfo>;
  const Bus bus;
  Watcher<TestType> watcher(bus.domain_id());
  const dds::Discovery discovery(watcher.participant());
  auto relay = bus.ros2({"--ros-distro", humble ? "humble" : "jazzy", "--enclave", "/x", "--namespace",
                         "/robot", "--name", "kart", "--path", "5", "--remap", "hedge_7/path:=~/way"});
  REQUIRE(watcher.wait_for_count(1));
  const std::string participant = watcher.messages.front().participant;
  CHECK(writers_of(discovery, participant, topics_of_beacon_7).empty());

  const auto bridge = bus.bridge({});
  // The node may announce them together or one by one, before or after discovery.
  std::set<std::string> writers;
  const auto tells_of_all = [&] {
    writers = writers_of(discovery, participant, topics_of_beacon_7);
    if (writers.size() < topics_of_beacon_7.size()) return false;
    const GraphInfo& info = watcher.messages.back();
    if (info.nodes.size() != 1) return false;
    const auto& of_node = info.nodes[0].writers;
    return std::includes(of_node.begin(), of_node.end(), writers.begin(), writers.end());
  };
  REQUIRE(watcher.wait_until(tells_of_all));
  const GraphInfo info = watcher.messages.back();
  CHECK(info.participant == participant);
  CHECK(info.nodes[0].name_space == "/robot");
  CHECK(info.nodes[0].name == "kart");
  // Native topics do not belong to the node.
  const auto all = endpoints_of(discovery.writers(), participant);
  CHECK_FALSE(info.nodes[0].writers.contains(all.at("ros_discovery_info").key));

  const auto participants = discovery.participants();
  const auto found = std::find_if(participants.begin(), participants.end(),
                                  [&](const auto& each) { return each.key == participant; });
  REQUIRE(found != participants.end());
  CHECK(text_of(found->user_data) == "enclave=/x;");

  CHECK(relay->end_by(SIGTERM).code == 0);
  CHECK(watcher.wait_until([&] { return watcher.messages.back().nodes.empty(); }));
}

/// Waits until the latest message received by a process of this distribution lists the relay.
template <class Info>
bool lists_relay(Watcher<Info>& watcher) {
  return watcher.wait_until([&] {
    return !watcher.messages.empty() && watcher.messages.back().nodes.size() == 1 &&
           watcher.messages.back().nodes[0].name == "sonopose";
  });
}

SCENARIO("without ROS_DISTRO, the relay learns the layout of its announcement from the other processes") {
  using Humble = ros2::HumbleParticipantEntitiesInfo;
  using Jazzy = ros2::ParticipantEntitiesInfo;
  GIVEN("a relay that does not know the distribution") {
    const Bus bus;
    const auto relay = bus.ros2();
    const auto humble_lists_it = [&] {
      Watcher<Humble> watcher(bus.domain_id());
      return lists_relay(watcher);
    };
    const auto jazzy_lists_it = [&] {
      Watcher<Jazzy> watcher(bus.domain_id());
      return lists_relay(watcher);
    };
    THEN("a process of Humble lists it from the start, and one of Jazzy reads no node") {
      CHECK(humble_lists_it());
      Watcher<Jazzy> watcher(bus.domain_id());
      REQUIRE(watcher.wait_for_count(1));
      CHECK(watcher.messages.back().nodes.empty());
    }
    WHEN("a process of Jazzy appears, and then one of Humble") {
      auto newer = std::make_unique<RosProcess>(bus.domain_id(), jazzy_writers);
      THEN("each lists the relay as long as it is alone") {
        CHECK(jazzy_lists_it());
        CHECK(relay->wait_for_line(Stream::error, "announced as in Iron and later"));
        const RosProcess older(bus.domain_id(), humble_writers);
        CHECK(relay->wait_for_line(Stream::error, "announced as in Humble"));
        CHECK(humble_lists_it());
      }
    }
  }
}

}  // namespace sonopose::ros2_node_test
