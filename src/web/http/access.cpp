#include "web/http/access.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <stdexcept>
#include <sys/random.h>
#include <system_error>

namespace sonopose::web::http {
namespace {

bool is_ipv6(const std::string& address) {
  return address.find(':') != std::string::npos;
}

bool is_address(const std::string& address) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return ::inet_pton(is_ipv6(address) ? AF_INET6 : AF_INET, address.c_str(), bytes.data()) == 1;
}

/// Takes the same time wherever the texts differ, so that a token cannot be found character by character.
bool are_equal(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= a[i] == b[i] ? 0U : 1U;
  }
  return difference == 0;
}

bool is_this_machine(std::string_view host, const Endpoint& endpoint) {
  const std::string port = ":" + std::to_string(endpoint.port);
  const auto is = [&](const std::string& name) {
    return host == name + port || (endpoint.port == 80 && host == name);
  };
  const bool is_listened_on = is(is_ipv6(endpoint.address) ? "[" + endpoint.address + "]" : endpoint.address);
  return is("localhost") || is("127.0.0.1") || is("[::1]") || is_listened_on;
}

}  // namespace

Endpoint parse_endpoint(const std::string& text) {
  const auto fail = [&text] {
    throw std::invalid_argument("'" + text +
                                "' is not an address and a port from 0 to 65535, as 127.0.0.1:8080 or "
                                "[::1]:8080");
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) fail();
  Endpoint endpoint{.address = text.substr(0, colon), .port = 0};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, endpoint.port);
  if (error != std::errc() || stop != end) fail();
  if (endpoint.address.size() > 2 && endpoint.address.front() == '[' && endpoint.address.back() == ']') {
    endpoint.address = endpoint.address.substr(1, endpoint.address.size() - 2);
    if (!is_ipv6(endpoint.address)) fail();
  } else if (is_ipv6(endpoint.address)) {
    fail();
  }
  if (!is_address(endpoint.address)) fail();
  return endpoint;
}

std::string text_of(const Endpoint& endpoint) {
  const std::string port = ":" + std::to_string(endpoint.port);
  return (is_ipv6(endpoint.address) ? "[" + endpoint.address + "]" : endpoint.address) + port;
}

bool is_loopback(const Endpoint& endpoint) {
  if (!is_ipv6(endpoint.address)) return endpoint.address.starts_with("127.");
  in6_addr address{};
  return ::inet_pton(AF_INET6, endpoint.address.c_str(), &address) == 1 && IN6_IS_ADDR_LOOPBACK(&address);
}

Verdict judge(const AccessRules& rules, const Credentials& credentials) {
  if (is_loopback(rules.endpoint) && !is_this_machine(credentials.host, rules.endpoint)) {
    return Verdict::wrong_host;
  }
  const bool is_own = credentials.origin == "http://" + std::string(credentials.host);
  const bool is_listed =
      std::find(rules.origins.begin(), rules.origins.end(), credentials.origin) != rules.origins.end();
  if (!credentials.origin.empty() && !is_own && !is_listed) return Verdict::wrong_origin;
  if (!rules.token.empty() && !are_equal(credentials.token, rules.token)) return Verdict::wrong_token;
  return Verdict::allowed;
}

Target parse_target(std::string_view target) {
  const std::size_t question = target.find('?');
  Target parsed{.path = target.substr(0, question), .token = {}};
  std::string_view query = question == std::string_view::npos ? "" : target.substr(question + 1);
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    constexpr std::string_view key = "token=";
    if (query.substr(0, end).starts_with(key)) parsed.token = query.substr(key.size(), end - key.size());
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return parsed;
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::system_error(errno, std::generic_category(), "random numbers");
  }
  constexpr std::string_view digits = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) {
    token += digits[byte >> 4U];
    token += digits[byte & 15U];
  }
  return token;
}

}  // namespace sonopose::web::http
