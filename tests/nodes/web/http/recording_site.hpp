#pragma once
/// \file
/// Site that records the events of a server, and requests to it.

#include "support/http_socket.hpp"
#include "web/http/server.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <semaphore>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::web::http::test {

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
    const bool came = changed_.wait_for(lock, std::chrono::minutes(3), [&] {
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

inline ServerOptions options() {
  return {.endpoint = {"127.0.0.1", 0}, .token = {}, .origins = {}};
}

inline std::string host_line(const Server& server) {
  return "Host: " + text_of(server.endpoint()) + "\r\n";
}

inline std::string get(const Server& server, const std::string& target, const std::string& headers = "") {
  sonopose::test::HttpSocket socket(server.endpoint().port);
  socket.send("GET " + target + " HTTP/1.1\r\n" + host_line(server) + headers + "Connection: close\r\n\r\n");
  return socket.read_all();
}

inline std::string upgrade(const Server& server, const std::string& target, const std::string& protocols,
                           const std::string& headers = "") {
  return sonopose::test::upgrade_request(target, protocols, host_line(server) + headers);
}

}  // namespace sonopose::web::http::test
