#include "web/http/interfaces.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cstring>
#include <ifaddrs.h>
#include <memory>
#include <net/if.h>
#include <optional>
#include <string>

namespace sonopose::web::http {
namespace {

/// Address of an interface; empty for another family, and for addresses valid on one link only.
std::optional<std::string> address_of(const sockaddr& socket, bool has_ipv6) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (socket.sa_family == AF_INET) {
    sockaddr_in ipv4{};
    std::memcpy(&ipv4, &socket, sizeof ipv4);
    return ::inet_ntop(AF_INET, &ipv4.sin_addr, text.data(), text.size());
  }
  if (socket.sa_family != AF_INET6 || !has_ipv6) return {};
  sockaddr_in6 ipv6{};
  std::memcpy(&ipv6, &socket, sizeof ipv6);
  if (IN6_IS_ADDR_LINKLOCAL(&ipv6.sin6_addr)) return {};
  return ::inet_ntop(AF_INET6, &ipv6.sin6_addr, text.data(), text.size());
}

}  // namespace

std::vector<Endpoint> reachable(const Endpoint& endpoint) {
  const bool is_of_all = endpoint.address == "0.0.0.0" || endpoint.address == "::";
  if (!is_of_all) return {endpoint};
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return {endpoint};
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, ::freeifaddrs);
  std::vector<Endpoint> found;
  for (const ifaddrs* each = list; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || (each->ifa_flags & IFF_UP) == 0) continue;
    if (const auto address = address_of(*each->ifa_addr, endpoint.address == "::")) {
      found.push_back({.address = *address, .port = endpoint.port});
    }
  }
  std::stable_partition(found.begin(), found.end(), [](const Endpoint& each) { return !is_loopback(each); });
  return found.empty() ? std::vector{endpoint} : found;
}

}  // namespace sonopose::web::http
