#pragma once
/// \file
/// A WebSocket of the server.

#include "web/http/server_impl.hpp"

#include <deque>
#include <string_view>

namespace sonopose::web::http {

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

}  // namespace sonopose::web::http
