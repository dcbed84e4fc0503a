/// The server on a real socket, with requests byte by byte.

#include "web/http/server.hpp"

#include "support/http_socket.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

namespace server_test {

using namespace sonopose::web::http;
using sonopose::test::HttpSocket;
using namespace std::chrono_literals;
using Catch::Contains;
using Catch::StartsWith;

/// Serves one text and records the events.
class Site final : public Handler {
public:
  Response get(std::string_view path) override {
    if (path == "/throws") throw std::runtime_error("broken");
    if (path == "/large") return text_response(200, large());
    if (path == "/script.js") return text_response(200, "a script");
    return path == "/page" ? text_response(200, "the page") : text_response(404, "nothing\n");
  }
  /// Blocks that end with a line.
  static std::string large() {
    std::string text;
    for (int i = 0; i < large_blocks; ++i) text += std::string(400'000, 'x') + "end\n";
    return text;
  }
  static constexpr int large_blocks = 25;

  std::function<void(ClientId)> on_call;  ///< runs for a message "call" on the serving thread

  [[nodiscard]] bool is_public(std::string_view path) const override { return path == "/script.js"; }
  std::optional<std::string> choose_protocol(std::string_view path, const std::vector<std::string>& offered,
                                             bool is_foreign) override {
    if (path != "/ws" || is_foreign) return {};
    for (const std::string& each : offered) {
      if (each == "mine") return each;
    }
    return {};
  }
  [[nodiscard]] std::string why_refused(const std::vector<std::string>& offered, bool) const override {
    return offered == std::vector<std::string>{"hinted"} ? "there is a hint" : "";
  }
  void on_open(ClientId client, const std::string&) override {
    note("open", client);
    if (fails_to_open_) throw std::runtime_error("broken");
  }
  void on_message(ClientId client, bool, std::string_view message) override {
    note("message " + std::string(message), client);
    if (message == "block") unblocked_.acquire();
    if (message == "throw") throw std::runtime_error("broken");
    if (message == "call") on_call(client);
  }
  void on_close(ClientId client) override { note("close", client); }
  void on_dropped(ClientId client, std::uint64_t total) override {
    note("dropped " + std::to_string(total), client);
  }

  /// Client of the next event that begins with `text`; fails the test after three minutes.
  ClientId wait_for(const std::string& text) {
    std::unique_lock lock(mutex_);
    ClientId client = 0;
    const bool came = changed_.wait_for(lock, 3min, [&] {
      for (std::size_t i = seen_; i < events_.size(); ++i) {
        if (!events_[i].first.starts_with(text)) continue;
        seen_ = i + 1;
        client = events_[i].second;
        return true;
      }
      return false;
    });
    CAPTURE(text);
    REQUIRE(came);
    return client;
  }

  /// Releases the serving thread from a message "block".
  void unblock() { unblocked_.release(); }
  void fail_to_open(bool fails) { fails_to_open_ = fails; }

private:
  void note(std::string event, ClientId client) {
    const std::lock_guard lock(mutex_);
    events_.emplace_back(std::move(event), client);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::pair<std::string, ClientId>> events_;
  std::size_t seen_ = 0;
  std::binary_semaphore unblocked_{0};
  std::atomic<bool> fails_to_open_ = false;
};

ServerOptions options() {
  return {.endpoint = {"127.0.0.1", 0}, .token = {}, .origins = {}};
}

std::string host_line(const Server& server) {
  return "Host: " + text_of(server.endpoint()) + "\r\n";
}

std::string get(const Server& server, const std::string& target, const std::string& headers = "") {
  HttpSocket socket(server.endpoint().port);
  socket.send("GET " + target + " HTTP/1.1\r\n" + host_line(server) + headers + "Connection: close\r\n\r\n");
  return socket.read_all();
}

std::string upgrade(const Server& server, const std::string& target, const std::string& protocols,
                    const std::string& headers = "") {
  return sonopose::test::upgrade_request(target, protocols, host_line(server) + headers);
}

SCENARIO("pages are served with headers that keep them safe") {
  Site site;
  Server server(options());
  const Serving serving(server, site);
  const std::string reply = get(server, "/page?x=1");
  CHECK_THAT(reply, StartsWith("HTTP/1.1 200 ") && Contains("\r\n\r\nthe page"));
  CHECK_THAT(reply, Contains("nosniff") && Contains("no-store") && Contains("default-src 'self'") &&
                        Contains("Content-Length: 8\r\n"));
  CHECK_THAT(get(server, "/other"), StartsWith("HTTP/1.1 404 "));
  CHECK_THAT(get(server, "/../../etc/passwd"), StartsWith("HTTP/1.1 404 "));
  CHECK_THAT(get(server, "/throws"), StartsWith("HTTP/1.1 500 "));
  CHECK_THAT(get(server, "/page"), StartsWith("HTTP/1.1 200 "));  // it continues serving
  WHEN("a connection is used again") {
    HttpSocket socket(server.endpoint().port);
    for (int i = 0; i < 3; ++i) {
      socket.send("GET /page HTTP/1.1\r\n" + host_line(server) + "\r\n");
      CHECK_THAT(socket.read_until("the page"), StartsWith("HTTP/1.1 200 "));
    }
    socket.send("HEAD /page HTTP/1.1\r\n" + host_line(server) + "Connection: close\r\n\r\n");
    CHECK_THAT(socket.read_all(),
               StartsWith("HTTP/1.1 200 ") && Contains("Content-Length: 8\r\n") && !Contains("the page"));
  }
}

SCENARIO("a request that must not be answered is refused") {
  Site site;
  ServerOptions with_token = options();
  with_token.token = "secret";
  Server server(with_token);
  const Serving serving(server, site);
  const auto raw = [&server](const std::string& text) {
    HttpSocket socket(server.endpoint().port);
    socket.send(text);
    return socket.read_all();
  };
  CHECK_THAT(get(server, "/page"), StartsWith("HTTP/1.1 401 ") && Contains("token"));
  CHECK_THAT(get(server, "/page?token=wrong"), StartsWith("HTTP/1.1 401 "));
  CHECK_THAT(get(server, "/page?token=secret"), StartsWith("HTTP/1.1 200 "));
  CHECK_THAT(get(server, "/page?token=secret", "Origin: https://evil.example.com\r\n"),
             StartsWith("HTTP/1.1 403 "));
  CHECK_THAT(get(server, "/script.js"), StartsWith("HTTP/1.1 200 ") && Contains("a script"));
  CHECK_THAT(get(server, "/script.js", "Origin: https://evil.example.com\r\n"), StartsWith("HTTP/1.1 403 "));
  CHECK_THAT(raw(upgrade(server, "/script.js", "mine")), StartsWith("HTTP/1.1 401 "));
  CHECK_THAT(get(server, "/ws"), StartsWith("HTTP/1.1 401 "));
  CHECK_THAT(get(server, "/ws?token=secret"), StartsWith("HTTP/1.1 426 "));
  CHECK_THAT(raw("GET /page?token=secret HTTP/1.1\r\nHost: evil.example.com\r\n\r\n"),
             StartsWith("HTTP/1.1 403 "));
  CHECK_THAT(raw("POST /page?token=secret HTTP/1.1\r\n" + host_line(server) + "Content-Length: 0\r\n\r\n"),
             StartsWith("HTTP/1.1 405 "));
  CHECK_THAT(
      raw("POST /page?token=secret HTTP/1.1\r\n" + host_line(server) + "Content-Length: 9\r\n\r\n123456789"),
      StartsWith("HTTP/1.1 413 "));
  CHECK_THAT(raw("no request at all\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  CHECK_THAT(raw(upgrade(server, "/ws", "mine")), StartsWith("HTTP/1.1 401 "));
  CHECK_THAT(raw(upgrade(server, "/ws?token=secret", "mine", "Origin: https://evil.example.com\r\n")),
             StartsWith("HTTP/1.1 403 "));
  CHECK_THAT(raw(upgrade(server, "/ws?token=secret", "other, another")),
             StartsWith("HTTP/1.1 400 ") && Contains("known sub-protocol: other, another"));
  CHECK_THAT(raw(upgrade(server, "/ws?token=secret", "hinted")),
             StartsWith("HTTP/1.1 400 ") && Contains("there is a hint; the client offers: hinted"));
  CHECK_THAT(raw("GET /page HTTP/1.1\r\nHost: " + std::string(20'000, 'x')), StartsWith("HTTP/1.1 431 "));
}

SCENARIO("messages go both ways") {
  Site site;
  Server server(options());
  const Serving serving(server, site);
  HttpSocket socket(server.endpoint().port);
  socket.send(upgrade(server, "/ws", "other, mine"));
  const std::string accepted = socket.read_until("\r\n\r\n");
  CHECK_THAT(accepted, StartsWith("HTTP/1.1 101 ") && Contains("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") &&
                           Contains("Sec-WebSocket-Protocol: mine\r\n"));
  const ClientId client = site.wait_for("open");
  server.send({client}, std::make_shared<const std::string>("hello"), true, Loss::never);
  server.send({client, client + 1}, std::make_shared<const std::string>(70'000, 'x'), true, Loss::never);
  CHECK(socket.read_message() == "hello");
  CHECK(socket.read_message() == std::string(70'000, 'x'));
  socket.send_message("question");
  CHECK(site.wait_for("message question") == client);
  WHEN("the handler fails") {
    socket.send_message("throw");
    THEN("that connection is closed, others are served") {
      CHECK(site.wait_for("close") == client);
      CHECK_THAT(get(server, "/page"), StartsWith("HTTP/1.1 200 "));
    }
  }
  WHEN("a message is too long") {
    socket.send_message(std::string(70'000, 'x'));
    THEN("the connection is closed") {
      CHECK(site.wait_for("close") == client);
    }
  }
}

SCENARIO("messages are sent in the order in which they are given, by whatever thread") {
  Site site;
  Server server(options());
  site.on_call = [&server](ClientId client) {
    const auto give = [&](const char* text) {
      server.send({client}, std::make_shared<const std::string>(text), true, Loss::never);
    };
    give("first");
    std::thread([&] { give("second"); }).join();
  };
  const Serving serving(server, site);
  HttpSocket socket(server.endpoint().port);
  socket.send(upgrade(server, "/ws", "mine"));
  socket.read_until("\r\n\r\n");
  socket.send_message("call");
  CHECK(socket.read_message() == "first");
  CHECK(socket.read_message() == "second");
}

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

SCENARIO("a large file may take long, as long as the client takes it") {
  Site site;
  ServerOptions impatient = options();
  impatient.timeout_s = 3;
  Server server(impatient);
  const Serving serving(server, site);
  HttpSocket socket(server.endpoint().port, 65'536);
  const auto begin = std::chrono::steady_clock::now();
  socket.send("GET /large HTTP/1.1\r\n" + host_line(server) + "Connection: close\r\n\r\n");
  for (int i = 0; i < Site::large_blocks; ++i) {
    std::this_thread::sleep_for(160ms);
    REQUIRE(socket.read_until("end\n").size() > 400'000);
  }
  CHECK(std::chrono::steady_clock::now() - begin > 3s);
}

SCENARIO("an address that cannot be listened on is named") {
  Site site;
  Server server(options());
  const Serving serving(server, site);
  ServerOptions same = options();
  same.endpoint = server.endpoint();
  CHECK_THROWS_WITH(Server(same), Contains(text_of(server.endpoint())) && Contains("already in use") &&
                                      Contains("--listen"));
  same.endpoint = {"203.0.113.1", 0};  // an address of no machine
  CHECK_THROWS_WITH(Server(same), Contains("203.0.113.1:0"));
}

SCENARIO("a server ends while clients are connected") {
  Site site;
  auto server = std::make_unique<Server>(options());
  auto serving = std::make_unique<const Serving>(*server, site);
  HttpSocket socket(server->endpoint().port);
  socket.send(upgrade(*server, "/ws", "mine"));
  socket.read_until("\r\n\r\n");
  const ClientId client = site.wait_for("open");
  for (int i = 0; i < 100; ++i)
    server->send({client}, std::make_shared<const std::string>("x"), true, Loss::never);
  serving.reset();
  server->send({client}, std::make_shared<const std::string>("late"), true, Loss::never);  // has no effect
  server.reset();
  CHECK_THAT(socket.read_all(), !Contains("late"));
}

}  // namespace server_test
