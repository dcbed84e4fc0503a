/// The server on a real socket, with requests byte by byte.

#include "web/http/server.hpp"

#include "support/http_socket.hpp"
#include "web/http/recording_site.hpp"

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <thread>

namespace server_test {

using namespace sonopose::web::http;
using namespace sonopose::web::http::test;
using Catch::Contains;
using Catch::StartsWith;
using sonopose::test::HttpSocket;

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

SCENARIO("a request whose host or origin is unclear is refused") {
  Site site;
  Server server(options());
  const Serving serving(server, site);
  const auto reply = [&server](const std::string& headers) {
    HttpSocket socket(server.endpoint().port);
    socket.send("GET /page HTTP/1.1\r\n" + host_line(server) + headers + "Connection: close\r\n\r\n");
    return socket.read_all();
  };
  CHECK_THAT(reply(""), StartsWith("HTTP/1.1 200 "));
  CHECK_THAT(reply("Host: evil.example.com\r\n"),
             StartsWith("HTTP/1.1 400 ") && Contains("the header Host occurs twice"));
  CHECK_THAT(reply(host_line(server)), StartsWith("HTTP/1.1 400 "));
  CHECK_THAT(reply("Origin: http://a.example.com\r\nOrigin: null\r\n"),
             StartsWith("HTTP/1.1 400 ") && Contains("the header Origin occurs twice"));
  for (const char* const blank : {"Origin:\r\n", "Origin: \r\n", "Origin: \t \r\n"}) {
    CHECK_THAT(reply(blank), StartsWith("HTTP/1.1 400 ") && Contains("the header Origin is blank"));
  }
  CHECK_THAT(reply("Origin: \" \"\r\n"), StartsWith("HTTP/1.1 403 "));
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
