#include "ros2/bag/storage.hpp"

#include <algorithm>
#include <map>

namespace sonopose::ros2::bag {
namespace {

class McapStorage final : public Storage {
public:
  explicit McapStorage(const mcap::Reader& reader) : reader_{reader} {
    for (const auto& entry : reader.channels()) {  // clang 14 captures no structured binding
      const auto id = entry.first;
      const auto& channel = entry.second;
      const auto schema = reader.schemas().find(channel.schema_id);
      const std::string type = schema == reader.schemas().end() ? "" : schema->second.name;
      const auto& counts = reader.statistics().channel_message_counts;
      const auto count = counts.find(id);
      const auto known = std::ranges::find_if(topics_, [&](const BagTopic& topic) {
        return topic.name == channel.topic && topic.type == type &&
               topic.encoding == channel.message_encoding;
      });
      topic_of_channel_[id] = static_cast<std::size_t>(known - topics_.begin());
      BagTopic& topic = known == topics_.end()
                            ? topics_.emplace_back(BagTopic{
                                  .name = channel.topic, .type = type, .encoding = channel.message_encoding})
                            : *known;
      topic.messages += count == counts.end() ? 0 : count->second;
    }
  }

  [[nodiscard]] const std::string& name() const override { return reader_.name(); }
  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }
  [[nodiscard]] std::vector<std::string> damages() const override { return reader_.damages(); }

  void for_each(const std::set<std::size_t>& topics,
                const std::function<bool(const BagMessage&)>& use) const override {
    mcap::Messages messages(reader_, {.channel = [&](const mcap::Channel& channel) {
                              return topics.contains(topic_of_channel_.at(channel.id));
                            }});
    while (const auto message = messages.next()) {
      if (!use({topic_of_channel_.at(message->channel_id), message->log_time_ns, message->data})) return;
    }
  }

private:
  const mcap::Reader& reader_;
  std::vector<BagTopic> topics_;
  std::map<std::uint16_t, std::size_t> topic_of_channel_;
};

}  // namespace

std::unique_ptr<Storage> mcap_storage(const mcap::Reader& reader) {
  return std::make_unique<McapStorage>(reader);
}

}  // namespace sonopose::ros2::bag
