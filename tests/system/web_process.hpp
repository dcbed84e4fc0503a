#pragma once
/// \file
/// The program sonopose-web and its clients.

#include "support/bus.hpp"
#include "support/http_socket.hpp"
#include "support/matches.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace sonopose::test {

/// A started sonopose-web.
class Web {
public:
  Web(const Bus& bus, Arguments arguments) : Web(with_domain(std::move(arguments), bus)) {}
  /// Starts it without a bus.
  explicit Web(const Arguments& arguments) : process_(SONOPOSE_TEST_WEB, arguments) {
    REQUIRE(process_.wait_for_line(Stream::error, "the page is at "));
    const std::string text = process_.text(Stream::error);
    const auto page = first_match(text, R"(http://([0-9.]+):([0-9]+)/( with the token)?)");
    REQUIRE_FALSE(page.empty());
    host_ = page[1] + ":" + page[2];
    port_ = static_cast<std::uint16_t>(std::stoi(page[2]));
    if (page[3].empty()) return;
    REQUIRE(process_.wait_for_line(Stream::output, "?token="));
    const auto token = first_match(process_.text(Stream::output), R"(\?token=(\S+))");
    REQUIRE_FALSE(token.empty());
    token_ = token[1];
  }

  [[nodiscard]] const std::string& host() const { return host_; }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] const std::string& token() const { return token_; }
  Process& process() { return process_; }

  [[nodiscard]] std::string get(const std::string& target) const {
    HttpSocket socket(port_);
    socket.send("GET " + target + " HTTP/1.1\r\n" + host_line() + "Connection: close\r\n\r\n");
    return socket.read_all();
  }

  [[nodiscard]] std::string host_line() const { return "Host: " + host_ + "\r\n"; }

private:
  static Arguments with_domain(Arguments arguments, const Bus& bus) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(bus.domain_id())});
    return arguments;
  }

  Process process_;
  std::string host_;
  std::uint16_t port_ = 0;
  std::string token_;
};

/// Connection of a page, or of another client that sends JSON.
class Page {
public:
  explicit Page(const Web& web, const std::string& target = "/ws",
                const std::string& protocol = "sonopose.v1", const std::string& headers = "",
                int receive_buffer_bytes = 0)
      : socket_(web.port(), receive_buffer_bytes) {
    socket_.send(upgrade_request(target, protocol, web.host_line() + headers));
    REQUIRE_THAT(socket_.read_until("\r\n\r\n"), Catch::StartsWith("HTTP/1.1 101 "));
  }

  /// Next message, which may be binary.
  std::string next() { return socket_.read_message(); }

  void send(const nlohmann::json& message) const { socket_.send_message(message.dump()); }

  /// Next message with this op that `accepts` accepts. Fails the test after many others.
  template <class Accepts>
  nlohmann::json wait_for(const std::string& op, const Accepts& accepts) {
    for (int i = 0; i < 2000; ++i) {
      nlohmann::json message = nlohmann::json::parse(socket_.read_message());
      if (message["op"] == op && accepts(message)) return message;
    }
    FAIL("no " << op << " came");
    return {};
  }
  nlohmann::json wait_for(const std::string& op) {
    return wait_for(op, [](const nlohmann::json&) { return true; });
  }

private:
  HttpSocket socket_;
};

}  // namespace sonopose::test
