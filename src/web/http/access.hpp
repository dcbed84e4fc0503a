#pragma once
/// \file
/// Who may connect: where a server listens, and the rules for a request.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::web::http {

/// Where a server listens.
struct Endpoint {
  std::string address = "127.0.0.1";  ///< IPv4 or IPv6, numeric
  std::uint16_t port = 8080;          ///< 0: one that is free

  bool operator==(const Endpoint&) const = default;
};

/// From "127.0.0.1:8080" or "[::1]:8080". Throws std::invalid_argument, whose text has the value and the
/// form.
Endpoint parse_endpoint(const std::string& text);

/// "127.0.0.1:8080", "[::1]:8080".
std::string text_of(const Endpoint& endpoint);

/// Whether only this machine can connect.
bool is_loopback(const Endpoint& endpoint);

/// What a request must show.
struct AccessRules {
  Endpoint endpoint;                 ///< with its actual port
  std::string token;                 ///< empty: none is asked for
  std::vector<std::string> origins;  ///< of other pages that may connect, such as "https://app.example.com"
};

/// What a request shows.
struct Credentials {
  std::string_view host;    ///< header Host
  std::string_view origin;  ///< header Origin; empty: none, so it is not from another page of a browser
  std::string_view token;
};

enum class Verdict : std::uint8_t { allowed, wrong_host, wrong_origin, wrong_token };

/// Whether a page of another origin asks, whether it is allowed or not.
bool is_foreign(const Credentials& credentials);

/// "https://app.example.com" of "https://App.example.com/", as a browser sends it. "file://" and "null"
/// (local files, and frames without an origin) stay as they are. Throws std::invalid_argument, whose text has
/// the value and the form.
std::string parse_origin(std::string text);

/// Whether a text consists of the characters of a host and port. A header's text need not.
bool is_host(std::string_view text);

/// A page from elsewhere is refused by its origin, also one whose name was made to point here (DNS
/// rebinding): on loopback the host must be this machine, with any port; elsewhere there is a token that it
/// cannot know.
Verdict judge(const AccessRules& rules, const Credentials& credentials);

/// The path and the token of "/path?token=TOKEN"; other parameters are ignored.
struct Target {
  std::string_view path;
  std::string_view token;
};
Target parse_target(std::string_view target);

inline constexpr std::size_t least_token_size = 16;
/// Throws std::invalid_argument if a token is too short to be hard to guess, or has characters that a URL
/// cannot have.
void check_token(const std::string& token);

/// 32 characters that nobody can guess. Throws std::system_error.
std::string random_token();

}  // namespace sonopose::web::http
