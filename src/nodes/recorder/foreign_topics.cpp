#include "recorder/foreign_topics.hpp"

#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::recorder {
namespace {

/// True for the name in DDS of a topic or service of ROS 2.
bool is_of_ros2(const std::string& topic) {
  return topic.starts_with("rt/") || topic.starts_with("rq/") || topic.starts_with("rr/") ||
         topic == "ros_discovery_info";
}

std::string line(const std::string& topic, const std::string& type) {
  return fmt::format("not recorded: {} ({}), {}", text::escaped(topic), text::escaped(type),
                     dds::topics::find_topic(topic) != nullptr ? "which has another type in this version"
                                                               : "whose type this program does not know");
}

}  // namespace

std::vector<std::string> ForeignTopics::update(const std::vector<dds::FoundEndpoint>& writers,
                                               bool records_ros2) {
  std::map<std::string, std::size_t> now;
  std::map<std::string, std::string> types;
  for (const dds::FoundEndpoint& writer : writers) {
    const auto* const known = dds::topics::find_topic(writer.topic_name);
    if (known != nullptr && writer.topic_name == known->name && writer.type_name == known->type_name)
      continue;
    ++now[writer.topic_name];
    types[writer.topic_name] = writer.type_name;
  }
  std::vector<std::string> lines;
  std::vector<std::string> of_ros2;
  std::size_t unnamed = 0;
  for (const auto& [topic, count] : now) {
    if (writer_counts_.size() == max_named && !writer_counts_.contains(topic)) {
      ++unnamed;
      continue;
    }
    const auto [at, is_new] = writer_counts_.try_emplace(topic, count);
    at->second = std::max(at->second, count);
    if (!is_new) continue;
    if (!records_ros2 && is_of_ros2(topic)) {
      of_ros2.push_back(topic);
    } else {
      lines.push_back(line(topic, types[topic]));
    }
  }
  if (!of_ros2.empty()) {
    lines.push_back(fmt::format("not recorded: {} of ROS 2, such as {}; --ros2 records them",
                                text::count_text(of_ros2.size(), "topic"), text::escaped(of_ros2.back())));
  }
  unnamed_ = std::max(unnamed_, unnamed);
  return lines;
}

}  // namespace sonopose::recorder
