#pragma once
/// \file
/// Publishes /parameter_events: new, changed and deleted parameters of the node.

#include "ros2/relay/parameters.hpp"
#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <string>

namespace sonopose::ros2::relay {

/// The publisher of /parameter_events.
class ParameterEvents {
public:
  /// Throws dds::core::Exception.
  explicit ParameterEvents(ros2::Node& node);

  /// Publishes the differences between two settings of one beacon. No values: no parameters.
  void publish(const EffectiveSettings& before, const EffectiveSettings& after);

private:
  std::string node_;
  dds::pub::DataWriter<ros2::ParameterEvent> writer_;
};

}  // namespace sonopose::ros2::relay
