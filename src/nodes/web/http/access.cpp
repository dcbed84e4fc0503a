#include "web/http/access.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cctype>
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

/// Compares in constant time, so that a token cannot be found character by character.
bool are_equal(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= a[i] == b[i] ? 0U : 1U;
  }
  return difference == 0;
}

/// Host name: "127.0.0.1" of "127.0.0.1:8080", "[::1]" of "[::1]:8080".
std::string_view name_in(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const bool is_of_ipv6 = colon != std::string_view::npos && host.find(']', colon) != std::string_view::npos;
  return is_of_ipv6 ? host : host.substr(0, colon);
}

/// True for this machine with any port, such as that of a tunnel (ssh -L 9000:localhost:8080).
bool is_this_machine(std::string_view host, const Endpoint& endpoint) {
  const std::string_view name = name_in(host);
  const std::string own = is_ipv6(endpoint.address) ? "[" + endpoint.address + "]" : endpoint.address;
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]" || name == own;
}

bool has_only(std::string_view text, std::string_view further) {
  return std::all_of(text.begin(), text.end(), [&](char each) {
    return (std::isalnum(static_cast<unsigned char>(each)) != 0 && static_cast<unsigned char>(each) < 128) ||
           further.find(each) != std::string_view::npos;
  });
}

}  // namespace

Endpoint parse_endpoint(const std::string& text) {
  const auto fail = [&text] {
    throw std::invalid_argument("'" + text +
                                "' is not an address and a port from 0 to 65535, such as 127.0.0.1:8080 or "
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

bool is_foreign(const Credentials& credentials) {
  if (credentials.origin.empty()) return false;
  const std::string host(credentials.host);
  return credentials.origin != "http://" + host &&
         credentials.origin != "https://" + host;  // https: behind a proxy
}

std::string parse_origin(std::string text) {
  if (text == "file://" || text == "null") return text;  // origins without a host
  const std::string given = text;
  if (text.ends_with('/')) text.pop_back();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char each) { return static_cast<char>(std::tolower(each)); });
  const std::size_t scheme_end = text.find("://");
  const std::string host = scheme_end == std::string::npos ? "" : text.substr(scheme_end + 3);
  if (scheme_end == 0 || host.empty() || !has_only(text.substr(0, scheme_end), "+-.") || !is_host(host)) {
    throw std::invalid_argument("'" + given +
                                "' is not the origin of a page, such as https://app.foxglove.dev or "
                                "http://localhost:8000; that of a local file is file:// or null");
  }
  return text;
}

bool is_host(std::string_view text) {
  return !text.empty() && has_only(text, ".-_:[]");
}

void check_token(const std::string& token) {
  if (token.size() >= min_token_size && has_only(token, "._~-")) return;
  throw std::invalid_argument("the token must have at least " + std::to_string(min_token_size) +
                              " characters, of A-Z a-z 0-9 . _ ~ -");
}

Verdict judge(const AccessRules& rules, const Credentials& credentials) {
  if (is_loopback(rules.endpoint) && !is_this_machine(credentials.host, rules.endpoint)) {
    return Verdict::wrong_host;
  }
  const bool is_listed =
      std::find(rules.origins.begin(), rules.origins.end(), credentials.origin) != rules.origins.end();
  if (is_foreign(credentials) && !is_listed) return Verdict::wrong_origin;
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
