#include "web/page_clients.hpp"

#include <catch2/catch.hpp>

namespace page_clients_test {

using namespace sonopose::web;
using Texts = std::vector<std::string>;

/// Texts received by each client.
struct Received {
  std::map<http::ClientId, Texts> texts;
  PageClients pages{[this](const std::vector<http::ClientId>& clients, const std::string& text, http::Loss) {
    for (const http::ClientId client : clients) texts[client].push_back(text);
  }};
};

SCENARIO("a new page receives the latest of what is kept, and the events") {
  Received received;
  CHECK(received.pages.empty());
  received.pages.broadcast("frame", http::Loss::allowed);
  received.pages.broadcast_latest("settings 7", "old");
  received.pages.broadcast_latest("settings 7", "new");
  received.pages.broadcast_latest("settings 8", "gone");
  received.pages.forget("settings 8");
  for (int i = 0; i < 700; ++i) received.pages.broadcast_event("event " + std::to_string(i));
  received.pages.on_open(1, {"hello", ""});
  const Texts& texts = received.texts[1];
  REQUIRE(texts.size() == 502);
  CHECK(texts[0] == "hello");
  CHECK(texts[1] == "new");
  CHECK(texts[2] == "event 200");
  CHECK(texts.back() == "event 699");
}

SCENARIO("all open pages receive what is new") {
  Received received;
  received.pages.on_open(1, {"hello"});
  received.pages.on_open(2, {"hello"});
  received.pages.broadcast("a", http::Loss::never);
  received.pages.on_close(1);
  CHECK_FALSE(received.pages.has(1));
  received.pages.broadcast_event("b");
  CHECK(received.texts[1] == Texts{"hello", "a"});
  CHECK(received.texts[2] == Texts{"hello", "a", "b"});
}

}  // namespace page_clients_test
