/// Discovery of other ROS 2 processes, and the layout of `ros_discovery_info` that suits them.

#include "ros2/messages/raw_cdr.hpp"
#include "support/ros2_graph.hpp"
#include "support/test_domain.hpp"
#include <sonopose/ros2/node/graph.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>

namespace sonopose::graph_test {

using namespace sonopose::test;
using ros2::Distro;

constexpr TimeNs second = 1'000'000'000;

/// A relay without any other process: Humble's layout, and type hashes on its topics.
const RosProcess::Writers lone_relay{{"ros_discovery_info", ""}, {"rt/odom", a_type_hash}};

/// A domain with an observer.
class Observed {
public:
  [[nodiscard]] std::uint32_t domain_id() const { return domain_.id(); }
  ros2::Graph observe(SteadyTime now) { return observer_.observe(now); }
  [[nodiscard]] int changes() const { return changes_; }

private:
  TestDomain domain_;
  std::atomic<int> changes_ = 0;
  dds::domain::DomainParticipant participant_ =
      dds::ext::participant({.domain_id = domain_.id()}, ros2::participant_qos());
  ros2::GraphObserver observer_{participant_, [this] { ++changes_; }};
};

SCENARIO("the layout follows the other ROS 2 processes") {
  ::unsetenv("CYCLONEDDS_URI");
  GIVEN("an observer") {
    Observed graph;
    const auto layout = [&](SteadyTime now) { return ros2::layout_for(graph.observe(now)); };
    const SteadyTime start{second};
    WHEN("it is alone, or with a process that is not of ROS 2") {
      const RosProcess native(graph.domain_id(), {{"sonopose/imu", ""}}, "");
      THEN("there is no layout") {
        CHECK(layout(start) == std::nullopt);
        CHECK(layout(start + 3 * second) == std::nullopt);
      }
    }
    WHEN("there are processes of Humble, of Jazzy, or of both") {
      THEN("Humble's layout has precedence, because it harms neither") {
        auto older = std::make_unique<RosProcess>(graph.domain_id(), humble_writers);
        CHECK(layout(start) == Distro::humble);
        const RosProcess newer(graph.domain_id(), jazzy_writers);
        CHECK(layout(start) == Distro::humble);
        older.reset();
        CHECK(layout(start) == Distro::jazzy);
        CHECK(graph.changes() > 0);
      }
    }
    WHEN("a process has not announced what identifies it") {
      const RosProcess silent(graph.domain_id(), {});
      THEN("it is of Humble after 2 s") {
        CHECK(layout(start) == std::nullopt);
        CHECK(graph.observe(start).is_undecided);
        CHECK(layout(start + 2 * second) == Distro::humble);
        CHECK_FALSE(graph.observe(start + 2 * second).is_undecided);
      }
    }
    WHEN("a process has only topics, with type hashes") {
      const RosProcess newer(graph.domain_id(), {{"rt/odom", a_type_hash}});
      THEN("it is of Jazzy after 2 s") {
        CHECK(layout(start) == std::nullopt);
        CHECK(layout(start + 2 * second) == Distro::jazzy);
      }
    }
    WHEN("an old process of Jazzy ends, and has removed its endpoints but not itself") {
      RosProcess newer(graph.domain_id(), jazzy_writers);
      REQUIRE(layout(start) == Distro::jazzy);
      newer.remove_writers();
      THEN("it is still of Jazzy") {
        CHECK(layout(start + 3 * second) == Distro::jazzy);
      }
    }
    WHEN("another relay has not found anything either") {
      const RosProcess relay(graph.domain_id(), lone_relay);
      THEN("it says nothing") {
        CHECK(layout(start) == std::nullopt);
        CHECK(layout(start + 3 * second) == std::nullopt);
      }
    }
  }
}

/// Message of a participant with one node, in the layout of `Info`.
template <class Info, class Entities>
Bytes bytes_of_node() {
  Info info{};
  info.gid.data[0] = 7;
  Entities node{};
  std::string("/").copy(node.node_namespace, 1);
  std::string("kart").copy(node.node_name, 4);
  decltype(Info::gid) gid{};
  node.writer_gid_seq = {1, 1, &gid, false};
  info.node_entities_info_seq = {1, 1, &node, false};
  return RawTopic(dds::TopicTraits<Info>::descriptor()).bytes_of(&info);
}

SCENARIO("Humble's layout harms no reader of the later one; the opposite is not true") {
  GIVEN("the bytes of a participant with a node in both layouts") {
    using Humble = ros2::HumbleParticipantEntitiesInfo;
    using Jazzy = ros2::ParticipantEntitiesInfo;
    const Bytes humble_bytes = bytes_of_node<Humble, rmw_dds_common_humble_msg_dds__NodeEntitiesInfo_>();
    const Bytes jazzy_bytes = bytes_of_node<Jazzy, rmw_dds_common_msg_dds__NodeEntitiesInfo_>();
    THEN("a reader of the later layout reads Humble's as the same participant without nodes") {
      RawTopic topic(dds::TopicTraits<Jazzy>::descriptor());
      topic.read(humble_bytes, Jazzy{}, [](const Jazzy& info) {
        CHECK(info.gid.data[0] == 7);
        CHECK(info.node_entities_info_seq._length == 0);
      });
    }
    THEN("a reader of Humble's layout cannot read the later one, or reads nodes without a name") {
      RawTopic topic(dds::TopicTraits<Humble>::descriptor());
      bool found = false;
      try {
        topic.read(jazzy_bytes, Humble{}, [&](const Humble& info) {
          for (std::uint32_t i = 0; i < info.node_entities_info_seq._length; ++i) {
            found = found || std::string(info.node_entities_info_seq._buffer[i].node_name) == "kart";
          }
        });
      } catch (const std::runtime_error&) {
        found = false;
      }
      CHECK_FALSE(found);
    }
    THEN("each reader reads its own") {
      RawTopic topic(dds::TopicTraits<Humble>::descriptor());
      topic.read(humble_bytes, Humble{}, [](const Humble& info) {
        REQUIRE(info.node_entities_info_seq._length == 1);
        CHECK(std::string(info.node_entities_info_seq._buffer[0].node_name) == "kart");
      });
    }
  }
}

}  // namespace sonopose::graph_test
