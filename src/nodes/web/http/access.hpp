#pragma once
/// \file
/// Access control: the address of a server, and the rules for a request.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::web::http {

/// Address and port of a server.
struct Endpoint {
  std::string address = "127.0.0.1";  ///< IPv4 or IPv6, numeric
  std::uint16_t port = 8080;          ///< 0: any free port

  bool operator==(const Endpoint&) const = default;
};

/// Parses "127.0.0.1:8080" or "[::1]:8080". Throws std::invalid_argument with the value and the expected
/// form.
Endpoint parse_endpoint(const std::string& text);

/// "127.0.0.1:8080", "[::1]:8080".
std::string text_of(const Endpoint& endpoint);

/// True if only this machine can connect.
bool is_loopback(const Endpoint& endpoint);

/// Requirements for a request.
struct AccessRules {
  Endpoint endpoint;                 ///< with the actual port
  std::string token;                 ///< empty: none required
  std::vector<std::string> origins;  ///< allowed other pages, such as "https://app.example.com"
};

/// Credentials of a request.
struct Credentials {
  std::string_view host;    ///< header Host
  std::string_view origin;  ///< header Origin; empty: not from another page of a browser
  std::string_view token;
};

enum class Verdict : std::uint8_t { allowed, wrong_host, wrong_origin, wrong_token };

/// True if a page of another origin asks, allowed or not.
bool is_foreign(const Credentials& credentials);

/// Normalises an origin as a browser sends it: "https://app.example.com" for "https://App.example.com/".
/// Keeps "file://" and "null" (local files, and frames without an origin). Throws std::invalid_argument with
/// the value and the expected form.
std::string parse_origin(std::string text);

/// True if a text has only characters of a host and port, which a header need not.
bool is_host(std::string_view text);

/// Judges a request. Pages from elsewhere are refused by their origin. A page whose name was made to point
/// here (DNS rebinding) fails another rule. On loopback, the host must be this machine, with any port;
/// elsewhere, the page cannot know the token.
Verdict judge(const AccessRules& rules, const Credentials& credentials);

/// Path and token of "/path?token=TOKEN"; other parameters are ignored.
struct Target {
  std::string_view path;
  std::string_view token;
};
Target parse_target(std::string_view target);

inline constexpr std::size_t min_token_size = 16;
/// Throws std::invalid_argument if a token is too short to be hard to guess, or has characters that a URL
/// cannot have.
void check_token(const std::string& token);

/// Token of 32 unpredictable characters. Throws std::system_error.
std::string random_token();

}  // namespace sonopose::web::http
