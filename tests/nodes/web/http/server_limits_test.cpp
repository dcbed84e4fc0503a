/// Limits of the server: numbers of connections, and clients that take messages slowly or not at all.

#include "support/http_socket.hpp"
#include "web/http/recording_site.hpp"
#include "web/http/server.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace server_limits_test {

using namespace sonopose::web::http;
using namespace sonopose::web::http::test;
using sonopose::test::HttpSocket;
using namespace std::chrono_literals;
using Catch::Contains;
using Catch::StartsWith;

SCENARIO("connections are bounded") {
  Site site;
  ServerOptions few = options();
  few.max_clients = 2;
  Server server(few);
  const Serving serving(server, site);
  auto first = std::make_unique<HttpSocket>(server.endpoint().port);
  first->send(upgrade(server, "/ws", "mine"));
  site.wait_for("open");
  const HttpSocket second(server.endpoint().port);
  second.send(upgrade(server, "/ws", "mine"));
  site.wait_for("open");
  {
    HttpSocket third(server.endpoint().port);
    third.send(upgrade(server, "/ws", "mine"));
    CHECK_THAT(third.read_all(), StartsWith("HTTP/1.1 503 ") && Contains("--max-clients"));
    CHECK_THAT(get(server, "/ws"), StartsWith("HTTP/1.1 503 ") && Contains("--max-clients"));
  }
  THEN("files are served nevertheless") {
    CHECK_THAT(get(server, "/page"), StartsWith("HTTP/1.1 200 "));
  }
  WHEN("one ends") {
    first.reset();
    site.wait_for("close");
    THEN("another one is accepted") {
      HttpSocket third(server.endpoint().port);
      third.send(upgrade(server, "/ws", "mine"));
      site.wait_for("open");
    }
  }
}

SCENARIO("connections that wait for a request give way to others") {
  Site site;
  ServerOptions few = options();
  few.max_requesting = 3;
  Server server(few);
  const Serving serving(server, site);
  std::vector<std::unique_ptr<HttpSocket>> idle;
  for (int i = 0; i < 6; ++i) {
    auto& socket = *idle.emplace_back(std::make_unique<HttpSocket>(server.endpoint().port));
    socket.send("GET /page HTTP/1.1\r\n" + host_line(server) + "\r\n");
    CHECK_THAT(socket.read_until("the page"), StartsWith("HTTP/1.1 200 "));
  }
  CHECK(idle[0]->read_all().empty());  // the connection that was idle longest
  idle[5]->send("GET /page HTTP/1.1\r\n" + host_line(server) + "\r\n");
  CHECK_THAT(idle[5]->read_until("the page"), StartsWith("HTTP/1.1 200 "));
}

SCENARIO("connections without a request end, and block nobody meanwhile") {
  const bool they_end = GENERATE(false, true);
  Site site;
  ServerOptions limited = options();
  limited.request_timeout_s = they_end ? 0.3 : 3600;
  Server server(limited);
  const Serving serving(server, site);
  std::vector<std::unique_ptr<HttpSocket>> idle;
  for (int i = 0; i < 16; ++i) {
    idle.push_back(std::make_unique<HttpSocket>(server.endpoint().port));
    if (i % 2 == 1) idle.back()->send("GET /page HTTP/1.1\r\n");
  }
  if (they_end) {
    for (const auto& socket : idle) CHECK(socket->read_all().empty());
  } else {
    CHECK_THAT(get(server, "/page"), StartsWith("HTTP/1.1 200 "));
  }
}

SCENARIO("a connection whose opening fails takes no place") {
  Site site;
  ServerOptions one = options();
  one.max_clients = 1;
  Server server(one);
  const Serving serving(server, site);
  site.fail_to_open(true);
  {
    HttpSocket socket(server.endpoint().port);
    socket.send(upgrade(server, "/ws", "mine"));
    site.wait_for("close");
    socket.read_all();
  }
  site.fail_to_open(false);
  HttpSocket next(server.endpoint().port);
  next.send(upgrade(server, "/ws", "mine"));
  CHECK_THAT(next.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 101 "));
}

SCENARIO("messages do not pile up before a thread that is busy") {
  Site site;
  ServerOptions small = options();
  small.max_posted_bytes = 1'000'000;
  Server server(small);
  const Serving serving(server, site);
  HttpSocket socket(server.endpoint().port);
  socket.send(upgrade(server, "/ws", "mine"));
  socket.read_until("\r\n\r\n");
  const ClientId client = site.wait_for("open");
  socket.send_message("block");
  site.wait_for("message block");
  std::vector<std::weak_ptr<const std::string>> frames;
  for (int i = 0; i < 100; ++i) {
    auto frame = std::make_shared<const std::string>(100'000, 'f');
    frames.emplace_back(frame);
    server.send({client}, std::move(frame), true, Loss::allowed);
  }
  const auto kept =
      std::count_if(frames.begin(), frames.end(), [](const auto& each) { return !each.expired(); });
  CHECK(kept == 10);
  site.unblock();
  server.send({client}, std::make_shared<const std::string>("important"), true, Loss::never);
  int received = 0;
  while (socket.read_message() != "important") ++received;
  CHECK(site.wait_for("dropped " + std::to_string(100 - received)) == client);
}

SCENARIO("a slow client loses frames, and nothing else") {
  Site site;
  Server server(options());
  const Serving serving(server, site);
  HttpSocket slow(server.endpoint().port, 4096);
  slow.send(upgrade(server, "/ws", "mine"));
  const ClientId client = site.wait_for("open");
  HttpSocket fast(server.endpoint().port);
  fast.send(upgrade(server, "/ws", "mine"));
  const ClientId other = site.wait_for("open");
  fast.read_until("\r\n\r\n");
  const auto frame = std::make_shared<const std::string>(50'000, 'f');
  constexpr int frames = 200;
  for (int i = 0; i < frames; ++i) {
    server.send({client, other}, frame, true, Loss::allowed);
    REQUIRE(fast.read_message().size() == frame->size());  // the fast client receives every frame
  }
  server.send({client}, std::make_shared<const std::string>("important"), true, Loss::never);
  slow.read_until("\r\n\r\n");
  int received = 0;
  while (slow.read_message() != "important") ++received;
  CHECK(received < frames);
  CHECK(received >= 20);  // allowed by the limit
  CHECK(site.wait_for("dropped " + std::to_string(frames - received)) == client);
}

SCENARIO("a client that takes nothing is disconnected") {
  Site site;
  ServerOptions impatient = options();
  impatient.max_queued_bytes = 100'000;
  impatient.timeout_s = 0.5;
  Server server(impatient);
  const Serving serving(server, site);
  const HttpSocket socket(server.endpoint().port, 4096);
  socket.send(upgrade(server, "/ws", "mine"));
  const ClientId client = site.wait_for("open");
  WHEN("it leaves too much that must not be dropped") {
    const auto text = std::make_shared<const std::string>(90'000, 'x');
    for (int i = 0; i < 20; ++i) server.send({client}, text, true, Loss::never);
    THEN("it is closed") {
      CHECK(site.wait_for("close") == client);
    }
  }
  WHEN("it answers no ping") {
    THEN("it is closed") {
      CHECK(site.wait_for("close") == client);
    }
  }
}

/// Takes a large file in more than 3 s, a block each 160 ms. Returns the longest time that a block took, and
/// whether all came.
std::pair<std::chrono::duration<double>, bool> take_large_file(Server& server) {
  using Clock = std::chrono::steady_clock;
  HttpSocket socket(server.endpoint().port, 65'536);
  const auto begin = Clock::now();
  std::chrono::duration<double> longest(0);
  socket.send("GET /large HTTP/1.1\r\n" + host_line(server) + "Connection: close\r\n\r\n");
  for (int i = 0; i < Site::large_blocks; ++i) {
    const auto before = Clock::now();
    std::this_thread::sleep_for(160ms);
    const bool came = socket.read_until("end\n").size() > 400'000;
    longest = std::max<std::chrono::duration<double>>(longest, Clock::now() - before);
    if (!came) return {longest, false};
  }
  CHECK(Clock::now() - begin > 3s);
  return {longest, true};
}

SCENARIO("a large file may take long, as long as the client takes it") {
  Site site;
  ServerOptions impatient = options();
  impatient.timeout_s = 3;
  Server server(impatient);
  const Serving serving(server, site);
  bool is_complete = false;
  for (int tries = 0; tries < 5 && !is_complete; ++tries) {
    const auto [longest, came] = take_large_file(server);
    is_complete = came;
    // A busy machine may keep the client from taking a block in time.
    if (!came) REQUIRE(longest.count() > 0.5 * impatient.timeout_s);
  }
  CHECK(is_complete);
}

}  // namespace server_limits_test
