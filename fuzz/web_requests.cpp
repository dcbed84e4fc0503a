// Parses the input of a client of the live page: a message of the page, one of Foxglove's protocol, the
// target and the headers of a request. Parses the input of an operator: an address to listen on, an origin, a
// token.

#include "support.hpp"
#include "web/foxglove/requests.hpp"
#include "web/http/access.hpp"
#include "web/page_requests.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>

using namespace sonopose;
using namespace sonopose::fuzz;
namespace http = web::http;

namespace {

void check_messages(std::string_view text) {
  const auto request = web::parse_page_request(text);
  if (const auto* const examination = std::get_if<web::ExamineRequest>(&request)) {
    promise(examination->seconds > 0 && examination->seconds < 3600, "an examination ends");
  }
  if (const auto* const change = std::get_if<web::ChangeRequest>(&request)) {
    promise(change->is_reset == change->settings.assignments.empty(), "a change has assignments");
  }
  web::foxglove::parse_request(text);
}

void check_options(const std::string& text) {
  accepts<std::invalid_argument>([&] {
    const auto endpoint = http::parse_endpoint(text);
    promise(http::parse_endpoint(text_of(endpoint)) == endpoint, "what was read is written");
    std::ignore = http::is_loopback(endpoint);
  });
  accepts<std::invalid_argument>([&] {
    const std::string origin = http::parse_origin(text);
    promise(http::parse_origin(origin) == origin, "the form of an origin is final");
  });
  if (accepts<std::invalid_argument>([&] { http::check_token(text); })) {
    const std::string target = "/ws?token=" + text;
    promise(http::parse_target(target).token == text, "a token fits into a target");
  }
}

/// Takes a line from the front of `text`.
std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  return line;
}

/// Checks access. The lines of the input are the host, the origin and the token of a request.
void check_access(std::string_view text) {
  static const std::array rules{
      http::AccessRules{.endpoint = {"127.0.0.1", 8080}, .token = {}, .origins = {}},
      http::AccessRules{.endpoint = {"::1", 80}, .token = {}, .origins = {"https://a.example.com"}},
      http::AccessRules{.endpoint = {"0.0.0.0", 80}, .token = http::random_token(), .origins = {}},
      http::AccessRules{
          .endpoint = {"192.168.1.4", 80}, .token = "0123456789abcdef", .origins = {"http://b"}}};
  const std::string_view host = take_line(text);
  const std::string_view origin = take_line(text);
  const http::Credentials shown{.host = host, .origin = origin, .token = take_line(text)};
  for (const http::AccessRules& each : rules) {
    if (judge(each, shown) != http::Verdict::allowed) continue;
    promise(each.token.empty() || shown.token == each.token, "a request without the token is refused");
    const bool is_listed = std::ranges::count(each.origins, origin) > 0;
    promise(is_listed || !is_foreign(shown), "a page from elsewhere is refused unless it is listed");
    promise(!is_loopback(each.endpoint) || host.starts_with("localhost") || host.starts_with("127.0.0.1") ||
                host.starts_with("[::1]"),
            "on loopback the host is this machine");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  check_messages(text);
  const auto target = http::parse_target(text);
  promise(target.path.size() + target.token.size() <= text.size(), "a target is a part of the text");
  check_options(std::string(text));
  check_access(text);
  return 0;
}
