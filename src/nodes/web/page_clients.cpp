#include "web/page_clients.hpp"

#include "web/live/event_json.hpp"

#include <algorithm>
#include <utility>

namespace sonopose::web {

// Texts are queued under the lock, so that all pages see one order.

void PageClients::on_open(http::ClientId client, std::vector<std::string> first) {
  const threads::Lock lock(mutex_);
  clients_.push_back(client);
  for (std::string& text : first) {
    if (!text.empty()) send_({client}, std::move(text), http::Loss::never);
  }
  for (const auto& entry : latest_) send_({client}, entry.second, http::Loss::never);
  for (const std::string& event : events_) send_({client}, event, http::Loss::never);
}

void PageClients::on_close(http::ClientId client) {
  const threads::Lock lock(mutex_);
  std::erase(clients_, client);
}

bool PageClients::has(http::ClientId client) const {
  const threads::Lock lock(mutex_);
  return std::find(clients_.begin(), clients_.end(), client) != clients_.end();
}

bool PageClients::empty() const {
  const threads::Lock lock(mutex_);
  return clients_.empty();
}

void PageClients::broadcast(std::string text, http::Loss loss) {
  const threads::Lock lock(mutex_);
  if (!clients_.empty()) send_(clients_, std::move(text), loss);
}

void PageClients::broadcast_event(std::string text) {
  const threads::Lock lock(mutex_);
  events_.push_back(text);
  if (events_.size() > live::max_events) events_.pop_front();
  if (!clients_.empty()) send_(clients_, std::move(text), http::Loss::never);
}

void PageClients::broadcast_latest(const std::string& name, std::string text) {
  const threads::Lock lock(mutex_);
  latest_[name] = text;
  if (!clients_.empty()) send_(clients_, std::move(text), http::Loss::never);
}

void PageClients::forget(const std::string& name) {
  const threads::Lock lock(mutex_);
  latest_.erase(name);
}

}  // namespace sonopose::web
