#include "topic_option.hpp"

#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/text/nearest.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

namespace sonopose::apps {

Check topic_name() {
  return {[](const std::string& text) {
            if (dds::topics::find_topic(text) != nullptr) return std::string();
            std::vector<std::string> names;
            for (const auto& topic : dds::topics::serialized_topics()) {
              names.push_back(dds::topics::short_name(topic.name));
            }
            const std::string meant = text::suggestion(dds::topics::short_name(text), names);
            return fmt::format("{}: unknown topic{} All topics: {}", text, meant.empty() ? "." : meant,
                               fmt::join(names, ", "));
          },
          ""};
}

}  // namespace sonopose::apps
