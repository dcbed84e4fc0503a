#include <sonopose/dds/binding/network_interfaces.hpp>

#include <catch2/catch.hpp>

namespace sonopose::dds::test::network_interfaces_test {

using Catch::Contains;
using Interfaces = std::vector<NetworkInterface>;

const NetworkInterface lo{.name = "lo", .address = "127.0.0.1", .loopback = true, .multicast = false};
const NetworkInterface docker0{.name = "docker0", .address = "172.17.0.1", .bridge = true};
const NetworkInterface idle_docker0{
    .name = "docker0", .address = "172.17.0.1", .carrier = false, .bridge = true};
const NetworkInterface wlan0{.name = "wlan0", .address = "192.0.2.5", .default_route_metric = 600};
const NetworkInterface eth0{.name = "eth0", .address = "10.0.0.2"};

NetworkChoice choice(Network network, const Interfaces& available, const std::vector<std::string>& names = {},
                     const UserNetwork& user = {}) {
  return choose_network({.network = network, .interfaces = names}, user, available);
}

std::vector<std::string> names_of(const NetworkChoice& choice) {
  std::vector<std::string> names;
  for (const NetworkInterface& each : choice.interfaces) names.push_back(each.name);
  return names;
}

using Names = std::vector<std::string>;

TEST_CASE("lan uses the interface with the default route, and says so") {
  const auto chosen = choice(Network::lan, {lo, docker0, wlan0});
  CHECK(names_of(chosen) == Names{"wlan0"});
  CHECK(chosen.is_ready);
  CHECK(chosen.text ==
        "wlan0 (192.0.2.5), it has the default route; not docker0 (172.17.0.1): select with --interface");
  CHECK(names_of(choice(Network::lan, {lo, wlan0, docker0})) == Names{"wlan0"});

  NetworkInterface cable = eth0;
  cable.default_route_metric = 100;
  CHECK(names_of(choice(Network::lan, {lo, wlan0, cable})) == Names{"eth0"});
  CHECK_THAT(choice(Network::lan, {lo, wlan0, cable}).text,
             Contains("its default route has the least metric"));
}

TEST_CASE("Without a default route, lan uses the most likely interface") {
  CHECK(names_of(choice(Network::lan, {lo, docker0, eth0})) == Names{"eth0"});
  CHECK_THAT(choice(Network::lan, {lo, docker0, eth0}).text, Contains("the others are bridges"));
  CHECK(choice(Network::lan, {lo, eth0}).text == "eth0 (10.0.0.2), no other is up");

  NetworkInterface unplugged = eth0;
  unplugged.carrier = false;
  const NetworkInterface second{.name = "eth1", .address = "10.0.1.2"};
  CHECK(names_of(choice(Network::lan, {lo, unplugged, second})) == Names{"eth1"});
  unplugged.default_route_metric = 100;
  CHECK(names_of(choice(Network::lan, {lo, unplugged, second})) == Names{"eth1"});
  CHECK(names_of(choice(Network::lan, {lo, unplugged, wlan0})) == Names{"wlan0"});
  CHECK(names_of(choice(Network::lan, {lo, eth0, second})) == Names{"eth0"});
  const NetworkInterface link_local{.name = "usb0", .address = "169.254.3.4"};
  CHECK(names_of(choice(Network::lan, {lo, link_local, eth0})) == Names{"eth0"});
}

TEST_CASE("lan is not ready with loopback and a bridge without a member: the network comes later") {
  for (const Interfaces& available : {Interfaces{lo}, Interfaces{lo, idle_docker0}, Interfaces{}}) {
    const auto chosen = choice(Network::lan, available);
    CHECK_FALSE(chosen.is_ready);
    CHECK(chosen.interfaces.empty());
    CHECK_THAT(chosen.text, Contains("no network interface is up with an IPv4 address"));
  }
  CHECK_THAT(choice(Network::lan, {lo, idle_docker0}).text,
             Contains("only lo (127.0.0.1), docker0 (172.17.0.1)"));
}

TEST_CASE("lan is not ready without a carrier, unless the interface is named") {
  NetworkInterface unplugged = eth0;
  unplugged.carrier = false;
  const auto chosen = choice(Network::lan, {lo, unplugged});
  CHECK_FALSE(chosen.is_ready);
  CHECK(chosen.text == "eth0 (10.0.0.2), which has no carrier");
  CHECK(choice(Network::lan, {lo, unplugged}, {"eth0"}).is_ready);
}

TEST_CASE("Named interfaces replace those of the network, by name or address") {
  CHECK(names_of(choice(Network::loopback, {lo, docker0, wlan0}, {"docker0"})) == Names{"docker0"});
  CHECK(names_of(choice(Network::lan, {lo, wlan0}, {"lo", "192.0.2.5", "wlan0"})) == Names{"lo", "wlan0"});
  const auto missing = choice(Network::lan, {lo, eth0}, {"eth0", "wlan0"});
  CHECK_FALSE(missing.is_ready);
  CHECK(missing.text ==
        "--interface wlan0 is not up with an IPv4 address; up: lo (127.0.0.1), eth0 (10.0.0.2)");
}

TEST_CASE("For ROS 2, loopback is always used, and is enough") {
  for (const Network network : {Network::ros_localhost, Network::ros_subnet}) {
    CHECK(names_of(choice(network, {lo, docker0, wlan0})) == Names{"lo", "wlan0"});
    CHECK(names_of(choice(network, {lo, docker0, wlan0}, {"docker0"})) == Names{"lo", "docker0"});
    CHECK(names_of(choice(network, {lo})) == Names{"lo"});
    CHECK(choice(network, {lo}).is_ready);
    CHECK(choice(network, {lo}).text ==
          "no network interface is up with an IPv4 address, only lo (127.0.0.1)");
    CHECK(choice(network, {lo}, {"lo"}).text == "lo (127.0.0.1), by --interface");
  }
}

TEST_CASE("CYCLONEDDS_URI decides alone, and contradicts --interface") {
  const UserNetwork user{.interfaces = {"eth0"}};
  const auto chosen = choice(Network::lan, {lo}, {}, user);
  CHECK(chosen.interfaces.empty());
  CHECK(chosen.is_ready);
  CHECK(chosen.text == "eth0, by CYCLONEDDS_URI");
  UserNetwork ipv6;
  ipv6.other_transport = true;
  CHECK(choice(Network::lan, {lo}, {}, ipv6).is_ready);
  CHECK_THROWS_WITH(choice(Network::lan, {lo}, {"wlan0"}, user),
                    Contains("--interface wlan0: CYCLONEDDS_URI"));
}

TEST_CASE("The table of the kernel names the default routes") {
  const auto routes = default_routes(
      "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\n"
      "wlan0\t00000000\t010200C0\t0003\t0\t0\t600\t00000000\t0\t0\t0\n"
      "wlan0\t00000000\t010200C0\t0003\t0\t0\t50\t00000000\t0\t0\t0\n"
      "docker0\t000011AC\t00000000\t0001\t0\t0\t0\t0000FFFF\t0\t0\t0\n"
      "tun0\t00000000\t00000000\t0001\t0\t0\t0\t00000080\t0\t0\t0\n"
      "cut off\n");
  CHECK(routes == std::map<std::string, std::uint32_t>{{"wlan0", 50}});
  CHECK(default_routes("").empty());
}

TEST_CASE("The configuration names the chosen interfaces, and turns multicast off on loopback alone") {
  const std::string here = domain_configuration(0, {.interfaces = {"127.0.0.1"}}, "");
  CHECK_THAT(here, Contains(R"(<NetworkInterface name="lo"/>)") && Contains("<AllowMulticast>false"));
  CHECK_THAT(domain_configuration(0, {.network = Network::lan}, "<Transport>udp6</Transport>"),
             !Contains("<NetworkInterface"));
}

}  // namespace sonopose::dds::test::network_interfaces_test
