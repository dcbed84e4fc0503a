#include "recorder/foreign_topics.hpp"

#include <sonopose/dds/topics/serialized_topics.hpp>

#include <algorithm>

namespace sonopose::recorder {

std::vector<std::string> ForeignTopics::update(const std::vector<dds::FoundEndpoint>& writers) {
  std::map<std::string, std::size_t> now;
  std::map<std::string, std::string> types;
  for (const dds::FoundEndpoint& writer : writers) {
    const auto* const known = dds::topics::find_topic(writer.topic_name);
    if (known != nullptr && writer.topic_name == known->name && writer.type_name == known->type_name)
      continue;
    ++now[writer.topic_name];
    types[writer.topic_name] = writer.type_name;
  }
  std::vector<std::string> found;
  std::size_t unnamed = 0;
  for (const auto& [topic, count] : now) {
    if (writer_counts_.size() == max_named && !writer_counts_.contains(topic)) {
      ++unnamed;
      continue;
    }
    const auto [at, is_new] = writer_counts_.try_emplace(topic, count);
    at->second = std::max(at->second, count);
    if (is_new) found.push_back(topic + " (" + types[topic] + ")");
  }
  unnamed_ = std::max(unnamed_, unnamed);
  return found;
}

}  // namespace sonopose::recorder
