#pragma once
/// \file
/// The network interfaces of this machine, and those that a domain uses.

#include <sonopose/dds/binding/domain.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::dds {

/// An interface that is up with an IPv4 address.
struct NetworkInterface {
  std::string name;
  std::string address;
  bool loopback = false;
  bool carrier = true;  ///< false: no cable, no access point, or a bridge without a running member
  bool multicast = true;
  bool bridge = false;  ///< joins other interfaces of this machine, as docker0 those of containers
  std::optional<std::uint32_t> default_route_metric = std::nullopt;  ///< empty: no default route

  bool operator==(const NetworkInterface&) const = default;
};

/// Returns the interfaces of this machine.
std::vector<NetworkInterface> network_interfaces();

/// Returns the least metric of the default routes of each interface. `table`: the text of
/// /proc/self/net/route.
std::map<std::string, std::uint32_t> default_routes(std::string_view table);

/// The interfaces of a domain.
struct NetworkChoice {
  std::vector<NetworkInterface> interfaces;  ///< empty: CYCLONEDDS_URI decides, or none is there yet
  bool is_ready = true;  ///< false: an interface is missing or has no carrier, as `text` says
  std::string text;      ///< "wlan0 (192.0.2.5): it has the default route", or what is missing
};

/// Chooses among `available`. `Network::lan` uses the interface with the default route, else the most likely
/// one: with a carrier, no bridge, with multicast, with an address that is not link-local. It is not ready
/// without a carrier; a bridge without one is never chosen. For ROS 2, loopback is ready too, unless
/// interfaces are named. Throws std::invalid_argument if the options and CYCLONEDDS_URI list interfaces.
NetworkChoice choose_network(const DomainOptions& options, const UserNetwork& user,
                             const std::vector<NetworkInterface>& available);
/// Chooses among the interfaces of this machine, with the CYCLONEDDS_URI of this process.
NetworkChoice choose_network(const DomainOptions& options);

/// The configuration of a domain on the chosen network; see domain.hpp.
std::string domain_configuration(std::uint32_t domain_id, const DomainOptions& options,
                                 const std::string& user_uri, const NetworkChoice& network);

/// Lists interfaces: "lo (127.0.0.1), eth0 (192.0.2.5)".
std::string list_of(const std::vector<NetworkInterface>& interfaces);

}  // namespace sonopose::dds
