/// What other processes learn of a node from `ros_discovery_info`, the type of which has two layouts.

#include "support/process.hpp"
#include "support/test_domain.hpp"
#include <sonopose/dds/discovery.hpp>
#include <sonopose/dds/waitset.hpp>
#include <sonopose/ros2/node.hpp>
#include <sonopose/ros2/type_hash.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

namespace {

using namespace sonopose;
using test::Process;
using Stream = Process::Stream;

/// A participant's message in plain values.
struct Told {
  struct Entities {
    std::string name_space;
    std::string name;
    std::set<std::string> readers;
    std::set<std::string> writers;
  };
  std::string participant;
  std::vector<Entities> nodes;
};

/// The GUID as Discovery writes it. What stands behind it must be zeros.
template <class Gid>
std::string key_of(const Gid& gid) {
  dds_guid_t guid{};
  std::copy_n(std::begin(gid.data), sizeof guid.v, std::begin(guid.v));
  CHECK(std::all_of(std::begin(gid.data) + sizeof guid.v, std::end(gid.data), [](auto b) { return b == 0; }));
  return dds::text_of(guid);
}

template <class Sequence>
std::set<std::string> keys_of(const Sequence& gids) {
  std::set<std::string> keys;
  for (std::uint32_t i = 0; i < gids._length; ++i) keys.insert(key_of(gids._buffer[i]));
  return keys;
}

template <class Info>
Told told_by(const Info& info) {
  Told told{.participant = key_of(info.gid), .nodes = {}};
  for (std::uint32_t i = 0; i < info.node_entities_info_seq._length; ++i) {
    const auto& node = info.node_entities_info_seq._buffer[i];
    told.nodes.push_back({.name_space = node.node_namespace,
                          .name = node.node_name,
                          .readers = keys_of(node.reader_gid_seq),
                          .writers = keys_of(node.writer_gid_seq)});
  }
  return told;
}

/// A process that watches the graph, as every ROS 2 process does.
template <class Info>
class Watcher {
public:
  explicit Watcher(std::uint32_t domain_id)
      : participant_(dds::make_participant({.domain_id = domain_id})),
        reader_(participant_, dds::Topic<Info>(participant_, "ros_discovery_info"),
                dds::Qos() << dds::policy::Reliability::reliable() << dds::policy::History::keep_all()
                           << dds::policy::Durability{dds::policy::DurabilityKind::transient_local}) {}

  /// Takes until `done()`.
  template <class Done>
  bool wait_until(const Done& done) {
    dds::StatusCondition condition(reader_);
    condition.enabled_statuses(dds::StatusMask::data_available() | dds::StatusMask::subscription_matched());
    dds::WaitSet waitset;
    waitset += condition;
    const auto give_up = std::chrono::steady_clock::now() + test::patience;
    const auto finished = [&] {
      reader_.take_each([&](const Info& info, const dds::SampleInfo&) { messages.push_back(told_by(info)); });
      return done();
    };
    while (!finished() && std::chrono::steady_clock::now() < give_up) {
      waitset.wait(give_up - std::chrono::steady_clock::now());
    }
    return done();
  }
  bool wait_for_count(std::size_t count) {
    return wait_until([&] { return messages.size() >= count; });
  }

  std::uint32_t writer_count() { return reader_.subscription_matched_status().current_count; }
  const dds::DomainParticipant& participant() const { return participant_; }

  std::vector<Told> messages;

private:
  dds::DomainParticipant participant_;
  dds::DataReader<Info> reader_;
};

std::string text_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

/// The endpoints of one participant by topic.
std::map<std::string, dds::FoundEndpoint> endpoints_of(const std::vector<dds::FoundEndpoint>& all,
                                                       const std::string& participant) {
  std::map<std::string, dds::FoundEndpoint> found;
  for (const auto& each : all) {
    if (each.participant_key == participant) found.emplace(each.topic_name, each);
  }
  return found;
}

std::string user_data_of(const dds::FoundEndpoint& endpoint) {
  return text_of(endpoint.qos.policy<dds::policy::UserData>().value_or(dds::policy::UserData{}).value);
}

template <class Info>
std::unique_ptr<Process> start_node(std::uint32_t domain_id) {
  const bool humble = std::is_same_v<Info, ros2::HumbleParticipantEntitiesInfo>;
  return std::make_unique<Process>(
      SONOPOSE_TEST_ROS2_NODE,
      std::vector<std::string>{std::to_string(domain_id), humble ? "humble" : "jazzy"});
}

}  // namespace

TEMPLATE_TEST_CASE("Others see the node, its readers and its writers, and no node when it has ended", "",
                   ros2::HumbleParticipantEntitiesInfo, ros2::ParticipantEntitiesInfo) {
  ::unsetenv("CYCLONEDDS_URI");
  const test::TestDomain domain;
  const bool late = GENERATE(false, true);
  CAPTURE(late);
  auto node = start_node<TestType>(domain.id());
  if (late) REQUIRE(node->wait_for_line(Stream::output, "ready"));
  Watcher<TestType> watcher(domain.id());
  REQUIRE(watcher.wait_for_count(1));

  const Told told = watcher.messages.back();
  const dds::Discovery discovery(watcher.participant());
  const auto participants = discovery.participants();
  const auto participant = std::find_if(participants.begin(), participants.end(),
                                        [&](const auto& each) { return each.key == told.participant; });
  REQUIRE(participant != participants.end());
  CHECK(text_of(participant->user_data) == "enclave=/;");

  REQUIRE(told.nodes.size() == 1);
  CHECK(told.nodes[0].name_space == "/hall");
  CHECK(told.nodes[0].name == "locator");
  // Endpoints that were announced have been discovered, or shortly will be.
  std::map<std::string, dds::FoundEndpoint> writers;
  std::map<std::string, dds::FoundEndpoint> readers;
  for (int attempt = 0; attempt < 1000 && (writers.size() < 3 || readers.empty()); ++attempt) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    writers = endpoints_of(discovery.writers(), told.participant);
    readers = endpoints_of(discovery.readers(), told.participant);
  }
  const auto& imu = writers.at("rt/hall/imu/data");
  const auto& fix = readers.at("rt/hall/locator/fix_in");
  CHECK(told.nodes[0].writers == std::set<std::string>{imu.key, writers.at("rt/tf_static").key});
  CHECK(told.nodes[0].readers == std::set<std::string>{fix.key});
  CHECK(imu.type_name == "sensor_msgs::msg::dds_::Imu_");
  CHECK(fix.type_name == "geometry_msgs::msg::dds_::PointStamped_");
  CHECK(user_data_of(imu) == "typehash=" + ros2::type_hash(imu.type_name) + ";");
  CHECK(user_data_of(fix) == "typehash=" + ros2::type_hash(fix.type_name) + ";");
  CHECK(writers.at("ros_discovery_info").type_name == "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");

  CHECK(node->end_by(SIGTERM).code == 0);
  CHECK(watcher.wait_until([&] { return watcher.messages.back().nodes.empty(); }));
  CHECK(watcher.wait_until([&] { return watcher.writer_count() == 0; }));
}

TEST_CASE("A node tells of changes, and of nothing else") {
  ::unsetenv("CYCLONEDDS_URI");
  const test::TestDomain domain;
  Watcher<ros2::ParticipantEntitiesInfo> watcher(domain.id());
  const dds::QosProvider qos;
  ros2::Node node(watcher.participant(), qos, ros2::NameResolver({}), ros2::Distro::jazzy);
  node.announce();
  node.announce();
  auto imu = node.make_writer<ros2::Imu>("imu", "ros2::Default");
  const std::string key = dds::text_of(dds::guid_of(imu));
  node.announce();
  node.forget(imu);
  imu.close();
  node.announce();
  REQUIRE(watcher.wait_for_count(3));
  REQUIRE(watcher.messages.size() == 3);
  CHECK(watcher.messages[0].nodes.at(0).writers.empty());
  CHECK(watcher.messages[0].nodes.at(0).name == "sonopose");
  CHECK(watcher.messages[1].nodes.at(0).writers == std::set<std::string>{key});
  CHECK(watcher.messages[2].nodes.at(0).writers.empty());
}
