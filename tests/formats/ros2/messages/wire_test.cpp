/// Packets on the wire, decoded by Wireshark.

#include "support/process.hpp"
#include "support/test_domain.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/type_hash.hpp>

#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

namespace sonopose::wire_test {

using test::Process;
using Stream = Process::Stream;

const char* const tshark = "/usr/bin/tshark";

/// Starts a decoded capture of messages with user data on a domain's loopback ports. Null if this machine
/// does not allow capturing.
std::unique_ptr<Process> capture(std::uint32_t domain_id) {
  if (!std::filesystem::exists(tshark)) return nullptr;
  const std::uint32_t first_port = 7400 + 250 * domain_id;
  const std::string ports =
      "udp portrange " + std::to_string(first_port) + "-" + std::to_string(first_port + 249);
  auto process =
      std::make_unique<Process>(tshark, std::vector<std::string>{"-n", "-l", "-i", "lo", "-f", ports, "-Y",
                                                                 "rtps.param.userData", "-V", "-O", "rtps"});
  if (!process->wait_for_line(Stream::error, "Capture started")) return nullptr;
  return process;
}

/// Captured DATA submessages.
std::vector<std::string> messages_in(const std::string& text) {
  const std::string begin_of_message = "submessageId: DATA";
  std::vector<std::string> messages;
  for (std::size_t begin = text.find(begin_of_message); begin != std::string::npos;) {
    const std::size_t end = text.find(begin_of_message, begin + 1);
    messages.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return messages;
}

std::string message_with(const std::vector<std::string>& messages, const std::string& what) {
  for (const std::string& message : messages) {
    if (message.find(what) != std::string::npos) return message;
  }
  return {};
}

/// The user data's first bytes as tshark prints them, at most 36.
std::string shown(const std::string& user_data) {
  std::string hex;
  for (const char c : user_data.substr(0, 36)) {
    for (const unsigned digit : {static_cast<unsigned char>(c) / 16U, static_cast<unsigned char>(c) % 16U}) {
      hex += "0123456789abcdef"[digit];
    }
  }
  return "userData: " + hex;
}

TEST_CASE("On the wire, the topics of a node have names, types, QoS and hashes of ROS 2") {
  ::unsetenv("CYCLONEDDS_URI");
  const test::TestDomain domain;
  const auto sniffer = capture(domain.id());
  if (!sniffer) {
    std::cout << "skipped: no tshark that can capture on lo; as root, apt-get install tshark\n";
    return;
  }
  Process node(SONOPOSE_TEST_ROS2_NODE, {std::to_string(domain.id()), "jazzy"});
  const auto other =
      dds::ext::participant({.domain_id = domain.id()});  // discovery data is sent only to other participants
  for (const char* const topic : {"topic: rt/hall/imu/data", "topic: rt/tf_static",
                                  "topic: rt/hall/locator/fix_in", "topic: ros_discovery_info"}) {
    REQUIRE(sniffer->wait_for_line(Stream::output, topic));
  }
  node.end_by(SIGTERM);
  sniffer->end_by(SIGINT);
  const auto messages = messages_in(sniffer->text(Stream::output));

  using Catch::Contains;
  CHECK_THAT(message_with(messages, "ENTITYID_BUILTIN_PARTICIPANT_WRITER"), Contains(shown("enclave=/;")));
  const std::string imu = message_with(messages, "topic: rt/hall/imu/data");
  CHECK_THAT(imu, Contains("typeName: sensor_msgs::msg::dds_::Imu_\n"));
  CHECK_THAT(imu, Contains("Kind: RELIABLE_RELIABILITY_QOS") && Contains("Depth: 10"));
  CHECK_THAT(imu, !Contains("PID_DEADLINE") && !Contains("PID_OWNERSHIP") && !Contains("PID_DURABILITY"));
  CHECK_THAT(imu, Contains(shown("typehash=" + ros2::type_hash("sensor_msgs::msg::dds_::Imu_"))));
  const std::string fix = message_with(messages, "topic: rt/hall/locator/fix_in");
  CHECK_THAT(fix, Contains("ENTITYID_BUILTIN_SUBSCRIPTIONS_WRITER"));
  CHECK_THAT(fix,
             !Contains("RELIABLE_RELIABILITY_QOS"));  // best effort, a reader's default, is omitted
  const std::string tf = message_with(messages, "topic: rt/tf_static");
  CHECK_THAT(tf, Contains("TRANSIENT_LOCAL_DURABILITY_QOS") && Contains("tf2_msgs::msg::dds_::TFMessage_"));
  const std::string graph = message_with(messages, "topic: ros_discovery_info");
  CHECK_THAT(graph, Contains("TRANSIENT_LOCAL_DURABILITY_QOS"));
  CHECK_THAT(graph, Contains("typeName: rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_\n"));
}

}  // namespace sonopose::wire_test
