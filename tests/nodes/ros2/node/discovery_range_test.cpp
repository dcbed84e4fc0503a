/// Discovery between the relay in each of ROS 2's ranges, native processes on loopback, and processes
/// configured like those of rmw_cyclonedds.

#include "support/process.hpp"
#include "support/test_domain.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <chrono>
#include <ifaddrs.h>
#include <iostream>
#include <memory>
#include <net/if.h>
#include <set>
#include <string>
#include <vector>

namespace sonopose::discovery_range_test {

using Command = sonopose_ResetCommand;

std::string configuration(const std::string& content) {
  return "<CycloneDDS><Domain>" + content + "</Domain></CycloneDDS>";
}

/// Configuration of rmw_cyclonedds per environment. Humble: none, or ROS_LOCALHOST_ONLY=1. Jazzy: its ranges.
const std::string humble = "<CycloneDDS/>";
const std::string humble_localhost =
    configuration(R"(<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>)");
const std::string jazzy_subnet = configuration(
    "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex></Discovery>");
const std::string jazzy_localhost = configuration(
    "<General><AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    R"(<Peers><Peer address="localhost"/></Peers></Discovery>)");

/// Returns true if an interface other than loopback has these flags.
bool has_interface(unsigned flags) {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return false;
  bool found = false;
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    found = found || (each->ifa_addr != nullptr && each->ifa_addr->sa_family == AF_INET &&
                      (each->ifa_flags & flags) == flags && (each->ifa_flags & IFF_LOOPBACK) == 0);
  }
  freeifaddrs(first);
  return found;
}

/// Indices of the processes with these configurations that exchange data with us in both directions.
std::set<std::size_t> met(dds::Network network, const std::vector<std::string>& others) {
  const test::TestDomain domain;
  ::unsetenv("CYCLONEDDS_URI");
  const dds::domain::DomainParticipant member =
      dds::ext::participant({.domain_id = domain.id(), .network = network});
  const dds::Qos qos = dds::Qos() << dds::policy::Reliability::Reliable()
                                  << dds::policy::Durability::TransientLocal();
  const dds::topic::Topic<Command> from(member, "test/from_peer");
  const dds::topic::Topic<Command> to(member, "test/to_peer");
  dds::sub::DataReader<Command> reader(dds::sub::Subscriber(member), from, qos);
  dds::pub::DataWriter<Command> writer(dds::pub::Publisher(member), to, qos);
  writer.write({.address = 1, .request_id = 1});

  std::vector<std::unique_ptr<test::Process>> processes;
  for (std::size_t i = 0; i < others.size(); ++i) {
    processes.push_back(std::make_unique<test::Process>(
        SONOPOSE_TEST_ROS2_PEER,
        std::vector<std::string>{std::to_string(domain.id()), others[i], std::to_string(i)}));
  }
  dds::core::cond::StatusCondition condition(reader);
  condition.enabled_statuses(dds::core::status::StatusMask::data_available());
  dds::core::cond::WaitSet waitset;
  waitset += condition;
  std::set<std::size_t> found;
  const auto give_up = std::chrono::steady_clock::now() + test::timeout;
  while (found.size() < others.size() && std::chrono::steady_clock::now() < give_up) {
    dds::ext::wait(waitset, give_up - std::chrono::steady_clock::now());
    dds::ext::take_each(
        reader, [&](const Command& command, const dds::sub::SampleInfo&) { found.insert(command.address); });
  }
  return found;
}

const std::string native = dds::domain_configuration(0, {}, {});

TEST_CASE("On loopback, a process discovers native processes and those of Humble with localhost only") {
  CHECK(met(dds::Network::loopback, {native, humble_localhost}) == std::set<std::size_t>{0, 1});
}

TEST_CASE(
    "In the range localhost, a process discovers native processes and ROS 2 nodes with range localhost") {
  CHECK(met(dds::Network::ros_localhost, {native, humble_localhost, jazzy_localhost, jazzy_subnet}) ==
        std::set<std::size_t>{0, 1, 2, 3});
}

TEST_CASE("In the range subnet, a process discovers native processes and ROS 2 nodes of every range") {
  if (!has_interface(IFF_UP | IFF_MULTICAST)) {
    std::cout << "skipped: no interface here that can multicast\n";
    return;
  }
  CHECK(met(dds::Network::ros_subnet, {native, humble_localhost, jazzy_localhost, jazzy_subnet, humble}) ==
        std::set<std::size_t>{0, 1, 2, 3, 4});
}

}  // namespace sonopose::discovery_range_test
