#pragma once
/// \file
/// The state of a server, which its connections share. Only server.cpp includes this and Boost.Beast, which
/// takes long to compile.

#include "logging/log.hpp"
#include "threads/mutex.hpp"
#include "web/http/access.hpp"
#include "web/http/refusal.hpp"
#include "web/http/server.hpp"

#include <fmt/format.h>

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <list>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace sonopose::web::http {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace message = boost::beast::http;
namespace websocket = boost::beast::websocket;
using tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;

class Server::Impl {
public:
  explicit Impl(ServerOptions options) : options_(std::move(options)), acceptor_(context_) {
    listen();
    const tcp::endpoint local = acceptor_.local_endpoint();
    options_.endpoint.port = local.port();
    rules_ = {.endpoint = options_.endpoint, .token = options_.token, .origins = options_.origins};
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() = default;

  void start(Handler& handler) {
    handler_ = &handler;
    accept();
    thread_ = std::thread([this] { context_.run(); });
  }

  void stop() {
    context_.stop();
    thread_.join();
  }

  [[nodiscard]] const Endpoint& endpoint() const { return options_.endpoint; }
  [[nodiscard]] const std::string& token() const { return options_.token; }

  /// Queues a message, from any thread.
  void send(std::vector<ClientId> clients, SharedText text, bool is_text, Loss loss);

private:
  class HttpConnection;
  class WebSocketConnection;

  void listen() {
    const std::string place = http::text_of(options_.endpoint);
    try {
      const tcp::endpoint endpoint(asio::ip::make_address(options_.endpoint.address), options_.endpoint.port);
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      const std::string cause = fmt::format("cannot listen on {}: {}", place, error.code().message());
      if (error.code() == asio::error::access_denied) throw std::invalid_argument("--listen: " + cause);
      const bool is_in_use = error.code() == asio::error::address_in_use;
      throw std::runtime_error(cause + (is_in_use ? "; choose another port with --listen" : ""));
    }
  }

  [[nodiscard]] std::chrono::milliseconds timeout() const { return milliseconds_of(options_.timeout_s); }
  [[nodiscard]] std::chrono::milliseconds request_timeout() const {
    return milliseconds_of(options_.request_timeout_s);
  }
  static std::chrono::milliseconds milliseconds_of(double duration_s) {
    return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(duration_s));
  }

  void accept();
  /// Counts messages that were dropped on their way to this thread.
  void take_drops();
  /// Closes the connection that has waited longest for a request, if there are too many. Returns false if
  /// none waits.
  bool make_room();

  /// Runs a call of the handler. Returns false if it threw.
  bool guarded(const auto& call) {
    try {
      call();
      return true;
    } catch (const std::exception& error) {
      logging::error(fmt::format("a request failed: {}", error.what()));
      return false;
    }
  }

  ServerOptions options_;
  AccessRules rules_;
  Handler* handler_ = nullptr;
  // Before the context, whose handlers count them down.
  std::size_t websockets_ = 0;
  std::list<HttpConnection*> requesting_;  ///< longest without a request first
  std::atomic<std::size_t> posted_bytes_ = 0;
  threads::Mutex drops_mutex_;
  std::map<ClientId, std::uint64_t> drops_ SONOPOSE_GUARDED_BY(drops_mutex_);
  RefusalLog refusal_log_;
  RefusalLog protocol_log_;  ///< refusals of WebSockets that passed the rules
  // No concurrency hint of 1: with it, work posted by the serving thread runs after later work of other
  // threads.
  asio::io_context context_;
  tcp::acceptor acceptor_;
  asio::steady_timer retry_{context_};
  ClientId next_id_ = 1;
  std::map<ClientId, std::shared_ptr<WebSocketConnection>> clients_;
  std::thread thread_;
};

}  // namespace sonopose::web::http
