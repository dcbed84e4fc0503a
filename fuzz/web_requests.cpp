// What a client of the live page sends: a message of the page, one of Foxglove's protocol, the target of a
// request, and an address to listen on.

#include "support.hpp"
#include "web/foxglove/protocol.hpp"
#include "web/http/access.hpp"
#include "web/page_messages.hpp"

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

using namespace sonopose;
using namespace sonopose::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto request = web::parse_page_request(text);
  if (const auto* const examination = std::get_if<web::ExamineRequest>(&request)) {
    promise(examination->seconds > 0 && examination->seconds < 3600, "an examination ends");
  }
  web::foxglove::parse_request(text);
  const auto target = web::http::parse_target(text);
  promise(target.path.size() + target.token.size() <= text.size(), "a target is a part of the text");
  accepts<std::invalid_argument>([&] {
    const auto endpoint = web::http::parse_endpoint(std::string(text));
    promise(web::http::parse_endpoint(text_of(endpoint)) == endpoint, "what was read is written");
  });
  return 0;
}
