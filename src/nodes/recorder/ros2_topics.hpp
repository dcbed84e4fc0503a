#pragma once
/// \file
/// The topics of ROS 2 on the bus, recorded as they appear.

#include "recorder/pipeline.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::recorder {

class Ros2Topics {
public:
  /// `pipeline` and `qos` must outlive it.
  Ros2Topics(Pipeline& pipeline, dds::domain::DomainParticipant participant, const dds::qos::Provider& qos)
      : pipeline_(pipeline), participant_(std::move(participant)), qos_(qos) {}

  /// Starts recording each topic among these writers that is new and whose type this program knows.
  void update(const std::vector<dds::FoundEndpoint>& writers);

  /// True if a topic, by its DDS name, is recorded.
  [[nodiscard]] bool contains(const std::string& topic_in_dds) const {
    return topics_.contains(topic_in_dds);
  }

private:
  void add(const dds::FoundEndpoint& writer, const std::string& name);

  Pipeline& pipeline_;
  dds::domain::DomainParticipant participant_;
  const dds::qos::Provider& qos_;
  std::set<std::string> topics_;  ///< by their DDS names
};

}  // namespace sonopose::recorder
