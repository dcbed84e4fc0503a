#pragma once
/// \file
/// The open pages: initial texts for each, and texts for all.

#include "threads/mutex.hpp"
#include "web/http/server.hpp"
#include <sonopose/samples/samples.hpp>

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace sonopose::web {

/// Sends texts to the open pages. Thread-safe.
class PageClients {
public:
  /// Sends without blocking; thread-safe.
  using Send = std::function<void(std::vector<http::ClientId> clients, std::string text, http::Loss loss)>;

  explicit PageClients(Send send) : send_(std::move(send)) {}

  /// Sends these texts unless they are empty, then the kept ones.
  void on_open(http::ClientId client, std::vector<std::string> first);
  void on_close(http::ClientId client);
  [[nodiscard]] bool has(http::ClientId client) const;
  [[nodiscard]] bool empty() const;

  /// Sends a text to all pages.
  void broadcast(std::string text, http::Loss loss);
  void broadcast_event(std::string text);  ///< the latest events are repeated to a new page
  /// Sends a text to all pages, and keeps the latest text of each name for new pages.
  void broadcast_latest(const std::string& name, std::string text);
  /// Drops the kept text of that name.
  void forget(const std::string& name);

private:
  Send send_;
  mutable threads::Mutex mutex_;
  std::vector<http::ClientId> clients_ SONOPOSE_GUARDED_BY(mutex_);
  std::deque<std::string> events_ SONOPOSE_GUARDED_BY(mutex_);
  std::map<std::string, std::string> latest_ SONOPOSE_GUARDED_BY(mutex_);
};

}  // namespace sonopose::web
