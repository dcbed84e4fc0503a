#include "web/http/access.hpp"

#include "web/http/interfaces.hpp"

#include <catch2/catch.hpp>

#include <set>

namespace access_test {

using namespace sonopose::web::http;
using Catch::Contains;

SCENARIO("an endpoint is a numeric address and a port") {
  CHECK(parse_endpoint("127.0.0.1:8080") == Endpoint{"127.0.0.1", 8080});
  CHECK(parse_endpoint("0.0.0.0:0") == Endpoint{"0.0.0.0", 0});
  CHECK(parse_endpoint("[::1]:65535") == Endpoint{"::1", 65535});
  CHECK(text_of(Endpoint{"::1", 80}) == "[::1]:80");
  for (const char* const text :
       {"", "8080", "localhost:8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:80x",
        "127.0.0.1:-1", "::1:80", "[127.0.0.1]:80", "300.0.0.1:80"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH(parse_endpoint(text),
                      Contains("'" + std::string(text) + "'") && Contains("127.0.0.1:8080"));
  }
}

SCENARIO("only loopback addresses are loopback") {
  CHECK(is_loopback({"127.0.0.1", 1}));
  CHECK(is_loopback({"127.9.9.9", 1}));
  CHECK(is_loopback({"::1", 1}));
  CHECK_FALSE(is_loopback({"0.0.0.0", 1}));
  CHECK_FALSE(is_loopback({"192.168.1.4", 1}));
  CHECK_FALSE(is_loopback({"::", 1}));
}

SCENARIO("a server of this machine answers no page from elsewhere") {
  AccessRules rules{.endpoint = {"127.0.0.1", 8080}, .token = {}, .origins = {}};
  const auto verdict = [&rules](std::string_view host, std::string_view origin = "",
                                std::string_view token = "") {
    return judge(rules, {.host = host, .origin = origin, .token = token});
  };
  CHECK(verdict("127.0.0.1:8080") == Verdict::allowed);
  CHECK(verdict("localhost:8080", "http://localhost:8080") == Verdict::allowed);
  WHEN("a name was made to point to this machine") {
    CHECK(verdict("evil.example.com:8080", "http://evil.example.com:8080") == Verdict::wrong_host);
  }
  WHEN("the port is that of a tunnel, or missing") {
    CHECK(verdict("localhost:9000", "http://localhost:9000") == Verdict::allowed);
    CHECK(verdict("[::1]:9000") == Verdict::allowed);
    CHECK(verdict("[::1]") == Verdict::allowed);
    CHECK(verdict("127.0.0.1") == Verdict::allowed);
    CHECK(verdict("localhost:9000", "http://localhost:8080") == Verdict::wrong_origin);
  }
  WHEN("there is no host, or one that only begins like this machine") {
    CHECK(verdict("") == Verdict::wrong_host);
    CHECK(verdict("localhost.evil.example.com:8080") == Verdict::wrong_host);
    CHECK(verdict("127.0.0.1.evil.example.com") == Verdict::wrong_host);
  }
  WHEN("the page connects, also from a proxy that speaks TLS") {
    CHECK(verdict("127.0.0.1:8080", "http://127.0.0.1:8080") == Verdict::allowed);
    CHECK(verdict("127.0.0.1:8080", "https://127.0.0.1:8080") == Verdict::allowed);
  }
  WHEN("a page from elsewhere connects") {
    CHECK(verdict("127.0.0.1:8080", "https://evil.example.com") == Verdict::wrong_origin);
    CHECK(verdict("127.0.0.1:8080", "null") == Verdict::wrong_origin);
    CHECK(verdict("127.0.0.1:8080", "http://127.0.0.1:9090") == Verdict::wrong_origin);
    CHECK(verdict("127.0.0.1:8080", "https://127.0.0.1:9090") == Verdict::wrong_origin);
    AND_WHEN("it is one that may") {
      rules.origins = {"https://app.example.com"};
      CHECK(verdict("127.0.0.1:8080", "https://app.example.com") == Verdict::allowed);
      CHECK(verdict("127.0.0.1:8080", "https://app.example.com.evil.org") == Verdict::wrong_origin);
      CHECK(verdict("127.0.0.1:8080", "file://") == Verdict::wrong_origin);
      CHECK(verdict("127.0.0.1:8080", "null") == Verdict::wrong_origin);
    }
    AND_WHEN("local files may") {
      rules.origins = {parse_origin("file://"), parse_origin("null")};
      CHECK(verdict("127.0.0.1:8080", "file://") == Verdict::allowed);
      CHECK(verdict("127.0.0.1:8080", "null") == Verdict::allowed);
      CHECK(verdict("127.0.0.1:8080", "https://app.example.com") == Verdict::wrong_origin);
    }
  }
  WHEN("there is a token") {
    rules.token = "0123456789";
    CHECK(verdict("127.0.0.1:8080", "", "0123456789") == Verdict::allowed);
    for (const char* const token : {"", "0", "012345678", "01234567890", "0123456780"}) {
      CAPTURE(token);
      CHECK(verdict("127.0.0.1:8080", "", token) == Verdict::wrong_token);
    }
  }
}

SCENARIO("elsewhere, the token decides") {
  const AccessRules rules{.endpoint = {"0.0.0.0", 8080}, .token = "secret", .origins = {}};
  CHECK(judge(rules, {.host = "robot.local:8080", .origin = "http://robot.local:8080", .token = "secret"}) ==
        Verdict::allowed);
  CHECK(judge(rules, {.host = "robot.local:8080", .origin = "http://robot.local:8080", .token = ""}) ==
        Verdict::wrong_token);
  CHECK(judge(rules, {.host = "robot.local:8080", .origin = "http://other.local", .token = "secret"}) ==
        Verdict::wrong_origin);
}

SCENARIO("the token is a part of the URL") {
  CHECK(parse_target("/").path == "/");
  CHECK(parse_target("/ws?token=abc").path == "/ws");
  CHECK(parse_target("/ws?token=abc").token == "abc");
  CHECK(parse_target("/?a=1&token=abc&b").token == "abc");
  CHECK(parse_target("/?mytoken=abc").token.empty());
  CHECK(parse_target("/?").token.empty());
}

SCENARIO("an origin is scheme, host and port") {
  CHECK(parse_origin("https://app.foxglove.dev") == "https://app.foxglove.dev");
  CHECK(parse_origin("https://App.Foxglove.dev/") == "https://app.foxglove.dev");
  CHECK(parse_origin("http://localhost:8000") == "http://localhost:8000");
  CHECK(parse_origin("file://") == "file://");  // origin of a local file, such as in Lichtblick Desktop
  CHECK(parse_origin("null") == "null");
  for (const char* const text : {"", "*", "app.foxglove.dev", "https://", "://x", "https://x/page",
                                 "https://x//", "https://a b", "file:", "file:///page.html", "NULL"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH(parse_origin(text), Contains("'" + std::string(text) + "'"));
  }
}

SCENARIO("a page of another origin is foreign") {
  CHECK_FALSE(is_foreign({.host = "localhost:8080", .origin = "", .token = ""}));
  CHECK_FALSE(is_foreign({.host = "localhost:8080", .origin = "http://localhost:8080", .token = ""}));
  CHECK(is_foreign({.host = "localhost:8080", .origin = "https://app.foxglove.dev", .token = ""}));
  CHECK(is_foreign({.host = "localhost:8080", .origin = "null", .token = ""}));
}

SCENARIO("a token is hard to guess and needs no escapes in a URL") {
  CHECK_NOTHROW(check_token("0123456789abcdef"));
  CHECK_NOTHROW(check_token("A.b_c~d-0123456789"));
  CHECK_NOTHROW(check_token(random_token()));
  for (const char* const token :
       {"", "0123456789abcde", "0123456789abcdef ", "0123456789&abcdef", "0123456789abcd\xc3\xa4"}) {
    CAPTURE(token);
    CHECK_THROWS_WITH(check_token(token), Contains("16"));
  }
}

SCENARIO("a server of all interfaces is reached at the address of one") {
  CHECK(reachable({"127.0.0.1", 80}) == std::vector{Endpoint{"127.0.0.1", 80}});
  const std::vector<Endpoint> all = reachable({"0.0.0.0", 8080});
  REQUIRE_FALSE(all.empty());
  for (const Endpoint& each : all) {
    CHECK(each.address != "0.0.0.0");
    CHECK(each.port == 8080);
  }
  CHECK(all.back() == Endpoint{"127.0.0.1", 8080});
}

SCENARIO("generated tokens differ") {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(random_token());
  CHECK(tokens.size() == 100);
  CHECK(tokens.begin()->size() == 32);
}

}  // namespace access_test
