#include <sonopose/dds/binding/network_interfaces.hpp>

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <ifaddrs.h>
#include <iterator>
#include <memory>
#include <net/if.h>
#include <netinet/in.h>
#include <sstream>
#include <stdexcept>
#include <tuple>

namespace sonopose::dds {
namespace {

std::string text_of(const NetworkInterface& interface) {
  return interface.name + " (" + interface.address + ")";
}

bool is_bridge(const std::string& name) {
  std::error_code no_sysfs;
  return std::filesystem::exists("/sys/class/net/" + name + "/bridge", no_sysfs);
}

/// True if the interface has a default route that leads somewhere.
bool has_route(const NetworkInterface& each) {
  return each.carrier && each.default_route_metric.has_value();
}

/// Orders interfaces: the most likely way to other machines comes first. Equal ones keep their order.
auto rank_of(const NetworkInterface& each) {
  constexpr std::uint64_t no_route = std::uint64_t{1} << 32U;
  const std::uint64_t metric = has_route(each) ? *each.default_route_metric : no_route;
  return std::tuple(metric, !each.carrier, each.bridge, !each.multicast,
                    each.address.starts_with("169.254."));
}

/// The reason for the first of the ranked interfaces.
std::string reason_for(const std::vector<NetworkInterface>& ranked) {
  if (ranked.size() == 1) return "no other is up";
  const NetworkInterface& best = ranked[0];
  const NetworkInterface& next = ranked[1];
  if (has_route(best)) {
    if (!has_route(next)) return "it has the default route";
    return *next.default_route_metric == *best.default_route_metric
               ? "the first one with a default route"
               : "its default route has the least metric";
  }
  if (rank_of(best) == rank_of(next)) return "the first of several alike, none has a default route";
  if (best.carrier != next.carrier) return "the others have no carrier";
  if (best.bridge != next.bridge) return "the others are bridges";
  if (best.multicast != next.multicast) return "the others have no multicast";
  return "the others have link-local addresses";
}

NetworkChoice choose_lan(const std::vector<NetworkInterface>& available) {
  std::vector<NetworkInterface> ranked;
  std::copy_if(available.begin(), available.end(), std::back_inserter(ranked),
               [](const NetworkInterface& each) { return !each.loopback && (each.carrier || !each.bridge); });
  if (ranked.empty()) {
    return {.interfaces = {},
            .is_ready = false,
            .text = "no network interface is up with an IPv4 address" +
                    (available.empty() ? std::string() : ", only " + list_of(available))};
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return rank_of(a) < rank_of(b); });
  if (!ranked.front().carrier) {
    return {.interfaces = {ranked.front()},
            .is_ready = false,
            .text = text_of(ranked.front()) + ", which has no carrier"};
  }
  NetworkChoice choice{.interfaces = {ranked.front()},
                       .is_ready = true,
                       .text = text_of(ranked.front()) + ", " + reason_for(ranked)};
  if (ranked.size() == 1) return choice;
  choice.text += "; not " + list_of({ranked.begin() + 1, ranked.end()}) + ": select with --interface";
  return choice;
}

NetworkChoice choose_named(const std::vector<std::string>& names,
                           const std::vector<NetworkInterface>& available) {
  NetworkChoice choice;
  for (const std::string& name : names) {
    const auto found = std::find_if(
        available.begin(), available.end(),
        [&name](const NetworkInterface& each) { return each.name == name || each.address == name; });
    if (found == available.end()) {
      const std::string up = available.empty() ? "none is" : "up: " + list_of(available);
      return {.interfaces = {},
              .is_ready = false,
              .text = std::string("--interface ")
                          .append(name)
                          .append(" is not up with an IPv4 address; ")
                          .append(up)};
    }
    const bool is_new =
        std::find(choice.interfaces.begin(), choice.interfaces.end(), *found) == choice.interfaces.end();
    if (is_new) choice.interfaces.push_back(*found);
  }
  choice.text = list_of(choice.interfaces) + ", by --interface";
  return choice;
}

/// Adds loopback in front of the interfaces for ROS 2. If they are missing, loopback is enough.
NetworkChoice with_loopback(NetworkChoice chosen, const std::vector<NetworkInterface>& available) {
  const auto found = std::find_if(available.begin(), available.end(),
                                  [](const NetworkInterface& each) { return each.loopback; });
  const NetworkInterface lo =
      found == available.end() ? NetworkInterface{.name = "lo", .address = "down", .loopback = true} : *found;
  std::erase(chosen.interfaces, lo);
  chosen.text = chosen.interfaces.empty() ? chosen.text : text_of(lo) + " and " + chosen.text;
  chosen.interfaces.insert(chosen.interfaces.begin(), lo);
  chosen.is_ready = true;
  return chosen;
}

}  // namespace

std::map<std::string, std::uint32_t> default_routes(std::string_view table) {
  std::map<std::string, std::uint32_t> metrics;
  std::istringstream lines{std::string(table)};
  std::string line;
  std::getline(lines, line);  // column titles
  while (std::getline(lines, line)) {
    // Iface Destination Gateway Flags RefCnt Use Metric Mask …; numbers are hexadecimal but for the metric
    std::istringstream words(line);
    std::array<std::string, 8> column;
    for (std::string& word : column) words >> word;
    const bool is_default = column[1] == "00000000" && column[7] == "00000000";
    std::uint32_t metric = 0;
    const auto [end, error] = std::from_chars(column[6].data(), column[6].data() + column[6].size(), metric);
    if (!is_default || error != std::errc()) continue;
    const auto [found, is_new] = metrics.emplace(column[0], metric);
    if (!is_new) found->second = std::min(found->second, metric);
  }
  return metrics;
}

std::vector<NetworkInterface> network_interfaces() {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, ::freeifaddrs);
  std::ostringstream table;
  // ProcSubset=pid of a unit hides /proc/net.
  table << std::ifstream("/proc/self/net/route").rdbuf();
  const auto routes = default_routes(table.str());
  std::vector<NetworkInterface> found;
  for (const ifaddrs* each = list; each != nullptr; each = each->ifa_next) {
    if ((each->ifa_flags & IFF_UP) == 0 || each->ifa_addr == nullptr) continue;
    if (each->ifa_addr->sa_family != AF_INET) continue;
    const std::string name = each->ifa_name;
    const bool has_entry =  // an alias such as eth0:1, or a second address
        std::any_of(found.begin(), found.end(), [&](const auto& other) { return other.name == name; });
    if (has_entry) continue;
    sockaddr_in address{};
    std::memcpy(&address, each->ifa_addr, sizeof address);
    std::array<char, INET_ADDRSTRLEN> text{};
    if (::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size()) == nullptr) continue;
    NetworkInterface& interface =
        found.emplace_back(NetworkInterface{.name = name,
                                            .address = text.data(),
                                            .loopback = (each->ifa_flags & IFF_LOOPBACK) != 0,
                                            .carrier = (each->ifa_flags & IFF_RUNNING) != 0,
                                            .multicast = (each->ifa_flags & IFF_MULTICAST) != 0,
                                            .bridge = is_bridge(name)});
    if (const auto route = routes.find(name); route != routes.end()) {
      interface.default_route_metric = route->second;
    }
  }
  return found;
}

std::string list_of(const std::vector<NetworkInterface>& interfaces) {
  std::string text;
  for (const NetworkInterface& each : interfaces) text.append(text.empty() ? "" : ", ").append(text_of(each));
  return text;
}

NetworkChoice choose_network(const DomainOptions& options, const UserNetwork& user,
                             const std::vector<NetworkInterface>& available) {
  if (!user.interfaces.empty() || user.other_transport) {
    if (!options.interfaces.empty()) {
      throw std::invalid_argument("--interface " + options.interfaces.front() +
                                  ": CYCLONEDDS_URI selects the network too; use one of them");
    }
    std::string names;
    for (const std::string& name : user.interfaces) names.append(names.empty() ? "" : ", ").append(name);
    return {.interfaces = {},
            .is_ready = true,
            .text = (names.empty() ? names : names + ", ") + "by CYCLONEDDS_URI"};
  }
  const bool for_ros = options.network == Network::ros_localhost || options.network == Network::ros_subnet;
  if (!options.interfaces.empty()) {
    const NetworkChoice named = choose_named(options.interfaces, available);
    return for_ros && named.is_ready ? with_loopback(named, available) : named;
  }
  if (options.network == Network::lan) return choose_lan(available);
  if (for_ros) return with_loopback(choose_lan(available), available);
  NetworkChoice loopback = with_loopback({}, available);
  loopback.text = list_of(loopback.interfaces);
  return loopback;
}

NetworkChoice choose_network(const DomainOptions& options) {
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  return choose_network(options, network_named_by(uri == nullptr ? "" : uri, resolve_domain_id(options)),
                        network_interfaces());
}

}  // namespace sonopose::dds
