#pragma once
/// \file
/// The open pages: what each must know when it opens, and what all receive.

#include "web/http/server.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace sonopose::web {

/// Thread-safe.
class PageClients {
public:
  /// Sends without blocking; thread-safe.
  using Send = std::function<void(std::vector<http::ClientId> clients, std::string text, http::Loss loss)>;

  explicit PageClients(Send send) : send_(std::move(send)) {}

  /// Sends these texts unless they are empty, then what is kept.
  void on_open(http::ClientId client, std::vector<std::string> first);
  void on_close(http::ClientId client);
  [[nodiscard]] bool has(http::ClientId client) const;
  [[nodiscard]] bool empty() const;

  /// To all.
  void broadcast(std::string text, http::Loss loss);
  void broadcast_event(std::string text);  ///< the latest are repeated to a new page
  /// The latest text of a name is sent to a new page.
  void broadcast_latest(const std::string& name, std::string text);
  /// Nothing of that name is kept any more.
  void forget(const std::string& name);

private:
  Send send_;
  mutable std::mutex mutex_;  ///< guards the rest
  std::vector<http::ClientId> clients_;
  std::deque<std::string> events_;
  std::map<std::string, std::string> latest_;
};

}  // namespace sonopose::web
