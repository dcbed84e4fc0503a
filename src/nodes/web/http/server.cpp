#include "web/http/server.hpp"

#include "web/http/http_connection.hpp"
#include "web/http/interfaces.hpp"
#include "web/http/server_impl.hpp"
#include "web/http/websocket_connection.hpp"

#include <algorithm>

namespace sonopose::web::http {
namespace {

/// Size of the kernel's buffer: small, so that a slow client lags little.
constexpr int send_buffer_bytes = 262'144;

}  // namespace

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
