// The only file that includes Boost.Beast, which takes long to compile.
#include "web/http/server.hpp"

#include "logging/log.hpp"
#include "threads/mutex.hpp"
#include "web/http/interfaces.hpp"
#include "web/http/refusal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <list>
#include <map>
#include <stdexcept>
#include <thread>
#include <utility>

namespace sonopose::web::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace message = boost::beast::http;
namespace websocket = boost::beast::websocket;
using tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;

std::string to_text(beast::string_view view) {
  return {view.data(), view.size()};
}

std::string_view to_view(beast::string_view view) {
  return {view.data(), view.size()};
}

/// Items of a header that is a comma-separated list.
std::vector<std::string> items_of(beast::string_view list) {
  std::vector<std::string> items;
  for (const auto& item : message::token_list(list)) items.push_back(to_text(item));
  return items;
}

/// Size of the kernel's buffer: small, so that a slow client lags little.
constexpr int send_buffer_bytes = 262'144;

}  // namespace

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
      throw std::runtime_error(fmt::format(
          "cannot listen on {}: {}{}", place, error.code().message(),
          error.code() == asio::error::address_in_use ? "; choose another port with --listen" : ""));
    }
  }

  [[nodiscard]] std::chrono::milliseconds timeout() const {
    return std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::duration<double>(options_.timeout_s));
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

/// One connection after its handshake.
class Server::Impl::WebSocketConnection : public std::enable_shared_from_this<WebSocketConnection> {
public:
  WebSocketConnection(Impl& server, beast::tcp_stream&& stream, ClientId id)
      : server_(server), id_(id), stream_(std::move(stream)) {
    ++server_.websockets_;
  }
  WebSocketConnection(const WebSocketConnection&) = delete;
  WebSocketConnection& operator=(const WebSocketConnection&) = delete;
  ~WebSocketConnection() { --server_.websockets_; }

  void accept(const message::request<message::empty_body>& request, std::string protocol) {
    beast::get_lowest_layer(stream_).expires_never();  // the next line sets its own timeout
    stream_.set_option(websocket::stream_base::timeout{std::chrono::seconds(5), server_.timeout(), true});
    stream_.auto_fragment(false);
    stream_.read_message_max(server_.options_.max_message_bytes);
    stream_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      response.set(message::field::sec_websocket_protocol, protocol);
    }));
    stream_.async_accept(request, [self = shared_from_this(), protocol](ErrorCode error) {
      if (error) return;
      self->server_.clients_[self->id_] = self;
      self->is_open_ = true;
      if (!self->server_.guarded([&] { self->server_.handler_->on_open(self->id_, protocol); })) {
        return self->end();
      }
      self->read();
    });
  }

  void add_dropped(std::uint64_t count) { dropped_ += count; }

  void send(const SharedText& text, bool is_text, Loss loss) {
    if (is_closing_) return;
    if (loss == Loss::allowed && unsent_bytes_ + text->size() > server_.options_.max_unsent_bytes) {
      ++dropped_;
      return;
    }
    if (unsent_bytes_ + text->size() > server_.options_.max_queued_bytes) {
      return disconnect();
    }
    unsent_bytes_ += text->size();
    queue_.push_back({text, is_text});
    if (queue_.size() == 1) write();
  }

private:
  struct Queued {
    SharedText text;
    bool is_text;
  };

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      if (error) return self->end();
      const auto data = self->buffer_.data();
      const std::string_view text(static_cast<const char*>(data.data()), data.size());
      const bool ok = self->server_.guarded(
          [&] { self->server_.handler_->on_message(self->id_, self->stream_.got_text(), text); });
      self->buffer_.consume(self->buffer_.size());
      if (!ok) self->disconnect();
      self->read();
    });
  }

  void write() {
    const Queued& next = queue_.front();
    stream_.text(next.is_text);
    stream_.async_write(asio::buffer(*next.text), [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->unsent_bytes_ -= self->queue_.front().text->size();
      self->queue_.pop_front();
      if (error) return self->end();
      if (!self->queue_.empty()) self->write();
      const bool has_space = self->unsent_bytes_ < self->server_.options_.max_unsent_bytes / 2;
      if (has_space && self->dropped_ != self->reported_dropped_ && self->is_open_) {
        self->reported_dropped_ = self->dropped_;
        self->server_.guarded([&] { self->server_.handler_->on_dropped(self->id_, self->dropped_); });
      }
    });
  }

  /// Disconnects without a close frame, which a stalled client would not read.
  void disconnect() {
    is_closing_ = true;
    beast::get_lowest_layer(stream_).close();  // pending reads and writes end with an error
  }

  /// Ends the connection, which is gone.
  void end() {
    if (!std::exchange(is_open_, false)) return;
    is_closing_ = true;
    server_.clients_.erase(id_);
    server_.guarded([&] { server_.handler_->on_close(id_); });
    beast::get_lowest_layer(stream_).close();
  }

  Impl& server_;
  ClientId id_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_;
  std::deque<Queued> queue_;
  std::size_t unsent_bytes_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t reported_dropped_ = 0;
  bool is_open_ = false;
  bool is_closing_ = false;
};

/// One connection until it becomes a WebSocket or ends.
class Server::Impl::HttpConnection : public std::enable_shared_from_this<HttpConnection> {
public:
  HttpConnection(Impl& server, tcp::socket&& socket)
      : server_(server),
        stream_(std::move(socket)),
        place_(server.requesting_.insert(server.requesting_.end(), this)) {}
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;
  ~HttpConnection() { server_.requesting_.erase(place_); }

  void start() {
    if (!server_.make_room()) return refuse(503, "too many connections at a time; try again later\n");
    read_request();
  }

  [[nodiscard]] bool is_waiting() const { return is_waiting_; }
  void close() {
    is_waiting_ = false;
    stream_.close();
  }

private:
  void read_request() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_.options_.max_header_bytes));
    parser_->body_limit(0);
    stream_.expires_after(std::chrono::seconds(10));
    is_waiting_ = true;
    message::async_read(stream_, buffer_, *parser_,
                        [self = shared_from_this()](ErrorCode error, std::size_t) { self->on_read(error); });
  }

  void on_read(ErrorCode error) {
    is_waiting_ = false;
    auto& all = server_.requesting_;
    all.splice(all.end(), all, place_);
    if (!error) return answer();
    if (error == message::error::header_limit) return refuse(431, "the header is too large\n");
    if (error == message::error::body_limit) return refuse(413, "a request has no body here\n");
    if (error == message::error::end_of_stream) return shut_down();
    static const auto& of_http = message::make_error_code(message::error::bad_method).category();
    if (error.category() == of_http) refuse(400, "not an HTTP request\n");
    // Otherwise the client is gone or too slow.
  }

  void answer() {
    const auto& request = parser_->get();
    const Target target = parse_target(to_view(request.target()));
    const Credentials credentials{.host = to_view(request[message::field::host]),
                                  .origin = to_view(request[message::field::origin]),
                                  .token = target.token};
    const bool is_upgrade = websocket::is_upgrade(request);
    const Verdict verdict = judge(server_.rules_, credentials);
    const bool is_exempt =
        verdict == Verdict::wrong_token && !is_upgrade && server_.handler_->is_public(target.path);
    if (verdict != Verdict::allowed && !is_exempt) {
      server_.refusal_log_.add(verdict, credentials);
      return refuse(verdict == Verdict::wrong_token ? 401 : 403, reason_of(verdict));
    }
    const bool is_full = server_.websockets_ >= server_.options_.max_clients;
    if (is_full && (is_upgrade || target.path == websocket_path)) {
      return refuse(
          503, fmt::format("there are {} connections already; see --max-clients\n", server_.websockets_));
    }
    if (is_upgrade) return upgrade(request, target.path, is_foreign(credentials));
    if (request.method() != message::verb::get && request.method() != message::verb::head) {
      return refuse(405, "only GET and HEAD\n");
    }
    if (target.path == websocket_path) return refuse(426, "this path is for a WebSocket\n");
    Response response;
    if (!server_.guarded([&] { response = server_.handler_->get(target.path); })) {
      return refuse(500, "the request failed; see the server's log\n");
    }
    write(std::move(response), request.method() == message::verb::head, request.keep_alive());
  }

  void upgrade(const message::request<message::empty_body>& request, std::string_view path, bool is_foreign) {
    const auto offered = items_of(request[message::field::sec_websocket_protocol]);
    std::optional<std::string> protocol;
    server_.guarded([&] { protocol = server_.handler_->choose_protocol(path, offered, is_foreign); });
    if (!protocol) {
      std::string reason;
      server_.guarded([&] { reason = server_.handler_->why_refused(offered, is_foreign); });
      reason += reason.empty() ? "the client offers no known sub-protocol: " : "; the client offers: ";
      reason += printable(to_view(request[message::field::sec_websocket_protocol]));
      server_.protocol_log_.add("refused a WebSocket: " + reason);
      return refuse(400, reason + '\n');
    }
    const auto connection =
        std::make_shared<WebSocketConnection>(server_, std::move(stream_), server_.next_id_++);
    connection->accept(request, *std::move(protocol));
  }

  void refuse(unsigned status, std::string text) {
    write(text_response(status, std::move(text)), false, false);
  }

  void write(Response&& response, bool head_only, bool keep_alive) {
    body_ = std::move(response.body);
    reply_.emplace(std::piecewise_construct, std::make_tuple(head_only || !body_ ? nullptr : body_->data(),
                                                             head_only || !body_ ? 0 : body_->size()));
    reply_->result(response.status);
    reply_->set(message::field::content_type, response.content_type);
    reply_->set(message::field::cache_control, "no-store");
    reply_->set("Referrer-Policy", "no-referrer");  // the URL has the token
    reply_->set("X-Content-Type-Options", "nosniff");
    reply_->set("X-Frame-Options", "DENY");
    reply_->set("Content-Security-Policy",
                "default-src 'self'; " + connect_rule() +
                    "img-src 'self' data:; style-src-attr 'unsafe-inline'; frame-ancestors 'none'; base-uri "
                    "'none'; form-action 'none'");
    reply_->keep_alive(keep_alive);
    reply_->content_length(body_ ? body_->size() : 0);
    serializer_.emplace(*reply_);
    write_some();
  }

  /// Sources for connect-src: not every browser applies 'self' to WebSockets.
  std::string connect_rule() const {
    const std::string_view host =
        to_view(parser_ ? parser_->get()[message::field::host] : beast::string_view());
    if (!is_host(host)) return {};
    return fmt::format("connect-src 'self' ws://{0} wss://{0}; ", host);
  }

  /// Writes a part of the reply. A body may take long, but each part has a timeout.
  void write_some() {
    stream_.expires_after(server_.timeout());
    message::async_write_some(stream_, *serializer_,
                              [self = shared_from_this()](ErrorCode error, std::size_t) {
                                if (error) return;
                                if (!self->serializer_->is_done()) return self->write_some();
                                if (!self->reply_->keep_alive()) return self->shut_down();
                                self->read_request();
                              });
  }

  void shut_down() {
    ErrorCode ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  Impl& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{65'536};
  std::list<HttpConnection*>::iterator place_;
  bool is_waiting_ = false;  ///< waits for a request
  std::optional<message::request_parser<message::empty_body>> parser_;
  SharedText body_;  ///< referenced by the reply
  using Reply = message::response<message::span_body<const char>>;
  std::optional<Reply> reply_;
  std::optional<message::response_serializer<message::span_body<const char>>> serializer_;
};

void Server::Impl::send(std::vector<ClientId> clients, SharedText text, bool is_text, Loss loss) {
  const std::size_t size = text->size();
  if (posted_bytes_.fetch_add(size) + size > options_.max_posted_bytes && loss == Loss::allowed) {
    posted_bytes_ -= size;
    const threads::Lock lock(drops_mutex_);
    for (const ClientId id : clients) ++drops_[id];
    return;
  }
  asio::post(context_, [this, clients = std::move(clients), text = std::move(text), is_text, loss] {
    posted_bytes_ -= text->size();
    take_drops();
    for (const ClientId id : clients) {
      if (const auto found = clients_.find(id); found != clients_.end()) {
        found->second->send(text, is_text, loss);
      }
    }
  });
}

void Server::Impl::take_drops() {
  std::map<ClientId, std::uint64_t> drops;
  {
    const threads::Lock lock(drops_mutex_);
    drops.swap(drops_);
  }
  for (const auto& [id, count] : drops) {
    if (const auto found = clients_.find(id); found != clients_.end()) found->second->add_dropped(count);
  }
}

bool Server::Impl::make_room() {
  if (requesting_.size() <= options_.max_requesting) return true;
  const auto waiting = std::find_if(requesting_.begin(), requesting_.end(),
                                    [](const HttpConnection* each) { return each->is_waiting(); });
  if (waiting == requesting_.end()) return false;
  (*waiting)->close();  // its handler destroys it later
  return true;
}

void Server::Impl::accept() {
  acceptor_.async_accept([this](ErrorCode error, tcp::socket socket) {
    if (error) {  // such as too many open files: retry later
      retry_.expires_after(std::chrono::milliseconds(200));
      retry_.async_wait([this](ErrorCode) { accept(); });
      return;
    }
    ErrorCode ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(send_buffer_bytes), ignored);
    std::make_shared<HttpConnection>(*this, std::move(socket))->start();
    accept();
  });
}

Response text_response(unsigned status, std::string text) {
  return {.status = status, .body = shared_text(std::move(text))};
}

SharedText shared_text(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

Server::Server(const ServerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Server::~Server() = default;

const Endpoint& Server::endpoint() const {
  return impl_->endpoint();
}

std::vector<std::string> Server::urls() const {
  const std::string query = impl_->token().empty() ? "" : "?token=" + impl_->token();
  std::vector<std::string> urls;
  for (const Endpoint& each : reachable(endpoint())) {
    urls.push_back("http://" + http::text_of(each) + "/" + query);
  }
  return urls;
}

void Server::send(std::vector<ClientId> clients, SharedText message, bool is_text, Loss loss) {
  impl_->send(std::move(clients), std::move(message), is_text, loss);
}

Serving::Serving(Server& server, Handler& handler) : server_(server) {
  server_.impl_->start(handler);
}

Serving::~Serving() {
  server_.impl_->stop();
}

}  // namespace sonopose::web::http
