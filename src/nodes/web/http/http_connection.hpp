#pragma once
/// \file
/// An HTTP connection of the server.

#include "web/http/server_impl.hpp"
#include "web/http/websocket_connection.hpp"

#include <optional>
#include <string_view>
#include <tuple>

namespace sonopose::web::http {

inline std::string to_text(beast::string_view view) {
  return {view.data(), view.size()};
}

inline std::string_view to_view(beast::string_view view) {
  return {view.data(), view.size()};
}

/// Items of a header that is a comma-separated list.
inline std::vector<std::string> items_of(beast::string_view list) {
  std::vector<std::string> items;
  for (const auto& item : message::token_list(list)) items.push_back(to_text(item));
  return items;
}

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
    stream_.expires_after(server_.request_timeout());
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
    if (const std::string fault = fault_of(request); !fault.empty()) return refuse(400, fault + '\n');
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

  /// Names the header that makes it unclear where a request goes or comes from; empty: none. A repeated
  /// header could mean another host to a proxy. A blank origin is not that of a program, which sends none.
  static std::string fault_of(const message::request<message::empty_body>& request) {
    for (const auto field : {message::field::host, message::field::origin}) {
      const std::string name = to_text(message::to_string(field));
      if (request.count(field) > 1) return fmt::format("the header {} occurs twice", name);
    }
    const bool has_origin = request.count(message::field::origin) > 0;
    const std::string_view origin = to_view(request[message::field::origin]);
    if (has_origin && origin.find_first_not_of(" \t") == std::string_view::npos) {
      return "the header Origin is blank";
    }
    return {};
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

}  // namespace sonopose::web::http
