#include "web/foxglove/topic_feed.hpp"

#include "clocks/clocks.hpp"
#include "threads/mutex.hpp"
#include "web/foxglove/protocol.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/idl/text.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonopose::web::foxglove {

/// One topic and its subscribers.
class TopicFeed::Topic final : public dds::sub::NoOpDataReaderListener<dds::Serialized> {
public:
  Topic(const dds::topics::SerializedTopic& topic, const Send& send) : topic_(topic), send_(send) {}

  void add(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos, Client client,
           SubscriptionId id) {
    {
      const threads::Lock lock(mutex_);
      subscribers_.emplace_back(client, id);
      if (subscribers_.size() > 1 && !topic_.is_latched(qos)) return;
    }
    // A new reader, so that a new client also receives the latest samples of a latched topic.
    reader_ = dds::core::null;
    reader_ = topic_.make_reader(participant, qos, this);
  }

  void remove(Client client, SubscriptionId id) {
    bool is_last = false;
    {
      const threads::Lock lock(mutex_);
      std::erase(subscribers_, std::pair(client, id));
      is_last = subscribers_.empty();
    }
    if (is_last) reader_ = dds::core::null;
  }

  void on_data_available(dds::SerializedReader& reader) noexcept override {
    const TimeNs received_ns = clocks::host_now();
    dds::ext::try_take_each(
        reader,
        [&](const dds::SerializedSample& sample, const dds::sub::SampleInfo&) {
          const threads::Lock lock(mutex_);
          for (const auto& [client, id] : subscribers_) {
            send_(client, message_data(id, received_ns, sample.bytes()), false);
          }
        },
        [](const dds::SerializedSample&, const dds::sub::SampleInfo&) {});
  }

private:
  const dds::topics::SerializedTopic& topic_;
  const Send& send_;
  threads::Mutex mutex_;
  std::vector<std::pair<Client, SubscriptionId>> subscribers_ SONOPOSE_GUARDED_BY(mutex_);
  dds::SerializedReader reader_ = dds::core::null;  ///< last, because its listener is this object
};

TopicFeed::TopicFeed(dds::domain::DomainParticipant participant, const dds::qos::Provider& qos, Send send)
    : participant_(std::move(participant)),
      qos_(qos),
      send_(std::move(send)),
      session_id_(std::to_string(clocks::host_now())) {
  for (const auto& topic : dds::topics::serialized_topics()) {
    channels_.push_back({.id = static_cast<ChannelId>(channels_.size() + 1),
                         .topic = topic.name,
                         .encoding = "cdr",
                         .schema_name = topic.type_name,
                         .schema = std::string(idl::text),
                         .schema_encoding = "omgidl"});
    topics_.push_back(std::make_unique<Topic>(topic, send_));
  }
}

TopicFeed::~TopicFeed() = default;

void TopicFeed::on_open(Client client) {
  clients_[client];
  send_(client, server_info("sonopose", session_id_), true);
  send_(client, advertise(channels_), true);
}

void TopicFeed::on_message(Client client, bool is_text, std::string_view text) {
  if (!is_text) return refuse(client, "binary messages of clients are not supported");
  const Request request = parse_request(text);
  if (const auto* const refused = std::get_if<Refused>(&request)) return refuse(client, refused->reason);
  if (const auto* const subscribed = std::get_if<Subscribe>(&request)) {
    for (const Subscribe::Item& item : subscribed->items) subscribe(client, item);
  } else if (const auto* const unsubscribed = std::get_if<Unsubscribe>(&request)) {
    for (const SubscriptionId id : unsubscribed->ids) unsubscribe(client, id);
  }
}

void TopicFeed::subscribe(Client client, const Subscribe::Item& item) {
  auto& subscriptions = clients_[client];
  if (item.channel_id == 0 || item.channel_id > channels_.size()) {
    return refuse(client, fmt::format("there is no channel {}", item.channel_id));
  }
  const bool has_channel = std::any_of(subscriptions.begin(), subscriptions.end(),
                                       [&](const auto& entry) { return entry.second == item.channel_id; });
  if (has_channel) {
    return refuse(client, fmt::format("channel {} has a subscription already", item.channel_id));
  }
  if (!subscriptions.try_emplace(item.id, item.channel_id).second) {
    return refuse(client, fmt::format("subscription {} exists already", item.id));
  }
  topics_[item.channel_id - 1]->add(participant_, qos_, client, item.id);
}

void TopicFeed::unsubscribe(Client client, SubscriptionId id) {
  auto& subscriptions = clients_[client];
  const auto found = subscriptions.find(id);
  if (found == subscriptions.end()) return refuse(client, fmt::format("there is no subscription {}", id));
  topics_[found->second - 1]->remove(client, id);
  subscriptions.erase(found);
}

void TopicFeed::on_close(Client client) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  for (const auto& [id, channel] : found->second) topics_[channel - 1]->remove(client, id);
  clients_.erase(found);
}

void TopicFeed::on_dropped(Client client, std::uint64_t total) {
  send_(client,
        status(StatusLevel::warning, fmt::format("{} dropped so far: this connection is slow",
                                                 text::count_text(total, "message was", "messages were"))),
        true);
}

void TopicFeed::send_time(TimeNs now_ns) {
  for (const auto& entry : clients_) send_(entry.first, time(now_ns), false);
}

void TopicFeed::refuse(Client client, const std::string& why) {
  send_(client, status(StatusLevel::error, why), true);
}

}  // namespace sonopose::web::foxglove
