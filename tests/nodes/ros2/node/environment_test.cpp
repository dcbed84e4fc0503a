#include <sonopose/ros2/node/environment.hpp>

#include <catch2/catch.hpp>

#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::environment_test {

using namespace sonopose::ros2;
using dds::Network;

Network network_for(const Variables& variables) {
  return with_discovery_range({}, variables).network;
}

std::vector<std::string> peers_for(const Variables& variables) {
  return with_discovery_range({}, variables).peers;
}

const std::string range = "ROS_AUTOMATIC_DISCOVERY_RANGE";
const std::string localhost_only = "ROS_LOCALHOST_ONLY";
const std::string static_peers = "ROS_STATIC_PEERS";

TEST_CASE("The discovery range equals that of ROS 2 nodes in the same shell") {
  CHECK(network_for({}) == Network::ros_subnet);
  CHECK(network_for({{range, ""}, {localhost_only, ""}}) == Network::ros_subnet);
  CHECK(network_for({{range, "SUBNET"}}) == Network::ros_subnet);
  CHECK(network_for({{range, "SYSTEM_DEFAULT"}}) == Network::ros_subnet);
  CHECK(network_for({{range, "LOCALHOST"}}) == Network::ros_localhost);
  CHECK(network_for({{localhost_only, "1"}}) == Network::ros_localhost);
  CHECK(network_for({{localhost_only, "1"}, {range, "SUBNET"}}) == Network::ros_localhost);
  CHECK(network_for({{localhost_only, "0"}, {range, "LOCALHOST"}}) == Network::ros_localhost);
  CHECK(network_for({{localhost_only, "0"}}) == Network::ros_subnet);
}

TEST_CASE("Static peers are used if the range allows them") {
  using Peers = std::vector<std::string>;
  CHECK(peers_for({{static_peers, "robot;192.0.2.7"}}) == Peers{"robot", "192.0.2.7"});
  CHECK(peers_for({{static_peers, ";robot;;"}, {range, "LOCALHOST"}}) == Peers{"robot"});
  CHECK(peers_for({{static_peers, "robot"}, {range, "SYSTEM_DEFAULT"}}).empty());
  CHECK(peers_for({{static_peers, "robot"}, {localhost_only, "1"}}).empty());
  const dds::DomainOptions options = with_discovery_range({.domain_id = 7, .partition = "hall"}, {});
  CHECK(options.domain_id == 7U);
  CHECK(options.partition == "hall");
}

TEST_CASE("Invalid values are rejected with variable, value and allowed values") {
  using Catch::Contains;
  for (const char* const value : {"2", "true", " 1", "no"}) {
    CHECK_THROWS_AS(network_for({{localhost_only, value}}), std::invalid_argument);
    CHECK_THROWS_WITH(network_for({{localhost_only, value}}),
                      Contains(localhost_only + " is '" + value + "'") && Contains("0 or 1"));
  }
  for (const char* const value : {"localhost", "LAN", "0"}) {
    CHECK_THROWS_AS(network_for({{range, value}}), std::invalid_argument);
    CHECK_THROWS_WITH(network_for({{range, value}}),
                      Contains(range + " is '" + value + "'") && Contains("LOCALHOST, SUBNET"));
  }
  CHECK_THROWS_WITH(network_for({{range, "OFF"}}), Contains("is 'OFF'"));
  for (const char* const value : {"a b", "robot;<x/>", "a, b"}) {
    CHECK_THROWS_AS(peers_for({{static_peers, value}}), std::invalid_argument);
    CHECK_THROWS_WITH(peers_for({{static_peers, value}}), Contains(static_peers + " is '" + value + "'"));
  }
}

TEST_CASE("The distribution determines the layout") {
  for (const char* const name : {"foxy", "galactic", "humble"}) CHECK(distro_named(name) == Distro::humble);
  for (const char* const name : {"iron", "jazzy", "kilted", "rolling"}) {
    CHECK(distro_named(name) == Distro::jazzy);
  }
  CHECK(distro_named("Humble") == std::nullopt);
  for (const std::string& name : distro_names()) CHECK(distro_named(name));
  CHECK(distro_of({}).distro == std::nullopt);
  CHECK(distro_of({}).warning.empty());
  CHECK(distro_of({{"ROS_DISTRO", "humble"}}).distro == Distro::humble);
  CHECK(distro_of({{"ROS_DISTRO", "humble"}}).warning.empty());
}

TEST_CASE("An unknown distribution counts as the newest one, with a warning") {
  const FoundDistro found = distro_of({{"ROS_DISTRO", "lyrical"}});
  CHECK(found.distro == Distro::jazzy);
  CHECK_THAT(found.warning, Catch::Contains("ROS_DISTRO is 'lyrical'"));
}

}  // namespace sonopose::environment_test
