#pragma once
/// \file
/// The topic /parameter_events: which parameters of the node are new, changed or deleted.

#include "ros2/relay/parameters.hpp"
#include <sonopose/ros2/messages/node.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <string>

namespace sonopose::ros2::relay {

class ParameterEvents {
public:
  /// Throws dds::Error.
  explicit ParameterEvents(ros2::Node& node);

  /// Publishes what differs between the settings of one beacon before and after. Without values: none.
  void publish(const EffectiveSettings& before, const EffectiveSettings& after);

private:
  std::string node_;
  dds::DataWriter<ros2::ParameterEvent> writer_;
};

}  // namespace sonopose::ros2::relay
