#pragma once
/// \file
/// The native topics for Foxglove's clients: their channels and their subscribers.

#include "web/foxglove/requests.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::web::foxglove {

/// A connection.
using Client = std::uint64_t;

/// Serves any number of clients. A topic has a reader while it has a subscriber. Use it from one thread;
/// samples leave on Cyclone's receive threads.
class TopicFeed {
public:
  /// Sends to one client without blocking; thread-safe.
  using Send = std::function<void(Client client, std::string message, bool is_text)>;

  /// `qos` must outlive the feed.
  TopicFeed(dds::domain::DomainParticipant participant, const dds::qos::Provider& qos, Send send);
  TopicFeed(const TopicFeed&) = delete;
  TopicFeed& operator=(const TopicFeed&) = delete;
  ~TopicFeed();

  void on_open(Client client);
  /// Handles a request. Answers with a status if it cannot be met.
  void on_message(Client client, bool is_text, std::string_view text);
  void on_close(Client client);
  void on_dropped(Client client, std::uint64_t total);

  /// Publishes the time of the host.
  void send_time(TimeNs now_ns);

private:
  class Topic;

  void subscribe(Client client, const Subscribe::Item& item);
  void unsubscribe(Client client, SubscriptionId id);
  void refuse(Client client, const std::string& why);

  dds::domain::DomainParticipant participant_;
  const dds::qos::Provider& qos_;
  Send send_;
  std::string session_id_;
  std::vector<Channel> channels_;
  std::vector<std::unique_ptr<Topic>> topics_;  ///< one per channel
  std::map<Client, std::map<SubscriptionId, ChannelId>> clients_;
};

}  // namespace sonopose::web::foxglove
