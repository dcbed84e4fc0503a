#pragma once
/// \file
/// A small server of HTTP and WebSocket on one port.

#include "web/http/access.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::web::http {

/// One WebSocket connection. Ids are never reused.
using ClientId = std::uint64_t;
using SharedText = std::shared_ptr<const std::string>;

/// Called when a server is ready, with the URLs of its page (Server::urls).
using OnReady = std::function<void(const std::vector<std::string>& urls)>;

/// Path of the page's WebSocket. A GET of it returns the reason for a refusal.
inline constexpr std::string_view websocket_path = "/ws";

/// Answer to a GET.
struct Response {
  unsigned status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  SharedText body;
};
Response text_response(unsigned status, std::string text);
SharedText shared_text(std::string text);

/// Called on the serving thread. An exception closes the connection.
class Handler {
public:
  Handler() = default;
  Handler(const Handler&) = delete;
  Handler& operator=(const Handler&) = delete;
  virtual ~Handler() = default;

  /// Answers a GET or HEAD of `path`, without the query.
  virtual Response get(std::string_view path) = 0;
  /// True if a GET of `path` needs no token: its content is the same for everybody, such as a script.
  [[nodiscard]] virtual bool is_public(std::string_view path) const = 0;
  /// Chooses one of the sub-protocols that a client offers, in its order; empty: refuses it. `is_foreign`:
  /// the client is a page of another origin.
  virtual std::optional<std::string> choose_protocol(std::string_view path,
                                                     const std::vector<std::string>& offered,
                                                     bool is_foreign) = 0;
  /// Reason for choosing none, for the client; empty: none is known.
  [[nodiscard]] virtual std::string why_refused(const std::vector<std::string>& /*offered*/,
                                                bool /*is_foreign*/) const {
    return {};
  }
  virtual void on_open(ClientId client, const std::string& protocol) = 0;
  virtual void on_message(ClientId client, bool is_text, std::string_view message) = 0;
  virtual void on_close(ClientId client) = 0;
  /// Reports the total number of messages that were dropped because the client was slow. Called when its
  /// queue has space again.
  virtual void on_dropped(ClientId client, std::uint64_t total) = 0;
};

struct ServerOptions {
  Endpoint endpoint;
  std::string token;                 ///< empty: none required
  std::vector<std::string> origins;  ///< origins of other pages that may connect
  std::size_t max_clients = 16;      ///< most WebSockets at a time
  std::size_t max_requesting = 64;   ///< most other connections; of more, the longest idle one is closed
  std::size_t max_header_bytes = 8192;
  std::size_t max_message_bytes = 65'536;     ///< message from a client
  std::size_t max_unsent_bytes = 1'048'576;   ///< limit for a client; beyond it, droppable ones are dropped
  std::size_t max_queued_bytes = 16'777'216;  ///< limit for a client; beyond it, other messages disconnect it
  std::size_t max_posted_bytes = 16'777'216;  ///< limit for the thread; beyond it, droppable ones are dropped
  double timeout_s = 30;                      ///< silence after which a client is disconnected
  double request_timeout_s = 10;              ///< time for a whole request, also for a first one
};

enum class Loss : std::uint8_t {
  never,   ///< disconnects a client that cannot take it
  allowed  ///< drops it if the client is slow
};

class Server {
public:
  /// Listens; answers nothing until it is served. Throws std::runtime_error with address and cause,
  /// std::invalid_argument if the port needs rights.
  explicit Server(const ServerOptions& options);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  /// Disconnects all clients.
  ~Server();

  /// The endpoint with its actual port.
  [[nodiscard]] const Endpoint& endpoint() const;

  /// URLs of "/", with the token, at each address where a browser reaches it.
  [[nodiscard]] std::vector<std::string> urls() const;

  /// Queues a message. From any thread; does not block.
  void send(std::vector<ClientId> clients, SharedText message, bool is_text, Loss loss);

private:
  friend class Serving;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Serves on its own thread during its life; once for each server. The handler is not called afterwards.
class Serving {
public:
  /// Both arguments must outlive this object.
  Serving(Server& server, Handler& handler);
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  ~Serving();

private:
  Server& server_;
};

}  // namespace sonopose::web::http
