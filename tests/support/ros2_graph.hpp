#pragma once
/// \file
/// The ROS 2 graph: `ros_discovery_info`, whose type has two layouts, and the endpoints that it lists.

#include "support/process.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::test {

/// A participant's message in plain values.
struct GraphInfo {
  struct Entities {
    std::string name_space;
    std::string name;
    std::set<std::string> readers;
    std::set<std::string> writers;
  };
  std::string participant;
  std::vector<Entities> nodes;
};

/// GUID in the format of DDS discovery. The remaining bytes must be zero.
template <class Gid>
std::string key_of(const Gid& gid) {
  dds_guid_t guid{};
  std::copy_n(std::begin(gid.data), sizeof guid.v, std::begin(guid.v));
  CHECK(std::all_of(std::begin(gid.data) + sizeof guid.v, std::end(gid.data), [](auto b) { return b == 0; }));
  return dds::ext::text_of(guid);
}

template <class Sequence>
std::set<std::string> keys_of(const Sequence& gids) {
  std::set<std::string> keys;
  for (std::uint32_t i = 0; i < gids._length; ++i) keys.insert(key_of(gids._buffer[i]));
  return keys;
}

template <class Info>
GraphInfo graph_info_of(const Info& info) {
  GraphInfo result{.participant = key_of(info.gid), .nodes = {}};
  for (std::uint32_t i = 0; i < info.node_entities_info_seq._length; ++i) {
    const auto& node = info.node_entities_info_seq._buffer[i];
    result.nodes.push_back({.name_space = node.node_namespace,
                            .name = node.node_name,
                            .readers = keys_of(node.reader_gid_seq),
                            .writers = keys_of(node.writer_gid_seq)});
  }
  return result;
}

/// Observes the graph, like every ROS 2 process.
template <class Info>
class Watcher {
public:
  explicit Watcher(std::uint32_t domain_id)
      : participant_(dds::ext::participant({.domain_id = domain_id})),
        reader_(dds::sub::Subscriber(participant_),
                dds::topic::Topic<Info>(participant_, "ros_discovery_info", dds::Qos()),
                dds::Qos() << dds::policy::Reliability::Reliable() << dds::policy::History::KeepAll()
                           << dds::policy::Durability::TransientLocal()) {}

  /// Takes until `done()`. Also polls it, because discovery does not trigger the wait set.
  template <class Done>
  bool wait_until(const Done& done) {
    dds::core::cond::StatusCondition condition(reader_);
    condition.enabled_statuses(dds::core::status::StatusMask::data_available() |
                               dds::core::status::StatusMask::subscription_matched());
    dds::core::cond::WaitSet waitset;
    waitset += condition;
    const auto give_up = std::chrono::steady_clock::now() + timeout;
    const auto finished = [&] {
      dds::ext::take_each(reader_, [&](const Info& info, const dds::sub::SampleInfo&) {
        messages.push_back(graph_info_of(info));
      });
      return done();
    };
    while (!finished() && std::chrono::steady_clock::now() < give_up) {
      dds::ext::wait(waitset, std::chrono::milliseconds(20));
    }
    return done();
  }
  bool wait_for_count(std::size_t count) {
    return wait_until([&] { return messages.size() >= count; });
  }

  std::int32_t writer_count() { return reader_.subscription_matched_status().current_count(); }
  const dds::domain::DomainParticipant& participant() const { return participant_; }

  std::vector<GraphInfo> messages;

private:
  dds::domain::DomainParticipant participant_;
  dds::sub::DataReader<Info> reader_;
};

/// A ROS 2 process as seen by others: a participant with an enclave, and writers by topic with their user
/// data.
class RosProcess {
public:
  using Writers = std::vector<std::pair<std::string, std::string>>;

  RosProcess(std::uint32_t domain_id, const Writers& writers, const std::string& user_data = "enclave=/;")
      : participant_(dds::ext::participant({.domain_id = domain_id}, with_user_data(user_data))) {
    for (const auto& [topic, text] : writers) {
      writers_.emplace_back(dds::pub::Publisher(participant_),
                            dds::topic::Topic<ros2::Imu>(participant_, topic, dds::Qos()),
                            with_user_data(text));
    }
  }

  /// Removes the writers, as a process that ends does before it removes itself.
  void remove_writers() { writers_.clear(); }

private:
  static dds::Qos with_user_data(const std::string& text) {
    return dds::Qos() << dds::policy::UserData({text.begin(), text.end()});
  }

  dds::domain::DomainParticipant participant_;
  std::vector<dds::pub::DataWriter<ros2::Imu>> writers_;
};

inline const std::string a_type_hash = "typehash=RIHS01_00;";
inline const RosProcess::Writers humble_writers{{"ros_discovery_info", ""}, {"rt/odom", ""}};
inline const RosProcess::Writers jazzy_writers{{"ros_discovery_info", a_type_hash}, {"rt/odom", a_type_hash}};

inline std::string text_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

/// Endpoints of one participant by topic.
inline std::map<std::string, dds::FoundEndpoint> endpoints_of(const std::vector<dds::FoundEndpoint>& all,
                                                              const std::string& participant) {
  std::map<std::string, dds::FoundEndpoint> found;
  for (const auto& each : all) {
    if (each.participant_key == participant) found.emplace(each.topic_name, each);
  }
  return found;
}

inline std::string user_data_of(const dds::FoundEndpoint& endpoint) {
  return text_of(endpoint.qos.policy_or_default<dds::policy::UserData>().value());
}

}  // namespace sonopose::test
