#include "web/http/refusal.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonopose::web::http {
namespace {

std::string line_of(Verdict verdict, const Credentials& credentials) {
  switch (verdict) {
    case Verdict::wrong_origin:
      return fmt::format("refused a page of {0}; --allow-origin {0} lets it use Foxglove's protocol{1}",
                         printable(credentials.origin),
                         credentials.origin == "null" ? ", but also a frame of any web site" : "");
    case Verdict::wrong_host:
      return fmt::format("refused a request for the host '{}', which is not this machine",
                         printable(credentials.host));
    case Verdict::wrong_token:
    case Verdict::allowed:
      break;
  }
  return "refused a request without the right token";
}

}  // namespace

std::string reason_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::wrong_host:
      return "refused: the header Host names another machine; a proxy needs a server that listens on an "
             "address other than loopback, with a token\n";
    case Verdict::wrong_origin:
      return "refused: the request comes from a page of another origin; see --allow-origin\n";
    case Verdict::wrong_token:
      return "refused: the token is missing or wrong; use the URL that the server printed\n";
    case Verdict::allowed:
      break;
  }
  return "";
}

std::string printable(std::string_view text) {
  std::string clean(text.substr(0, 200));
  std::replace_if(
      clean.begin(), clean.end(), [](char each) { return each < ' ' || each > '~'; }, '?');
  return clean;
}

void RefusalLog::add(Verdict verdict, const Credentials& credentials) {
  add(line_of(verdict, credentials));
}

void RefusalLog::add(const std::string& line) {
  constexpr std::chrono::seconds period(10);
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) {
    ++unlogged_;
    return;
  }
  next_ = now + period;
  const std::uint64_t before = std::exchange(unlogged_, 0);
  const std::string others = before > 0 ? fmt::format(" ({} more since the last such line)", before) : "";
  logging::warning(line + others);
}

}  // namespace sonopose::web::http
