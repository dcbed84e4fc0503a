#pragma once
/// \file
/// The parameters `qos_overrides.TOPIC.publisher.POLICY` of ROS 2, which change the QoS of a node's
/// endpoints.

#include <sonopose/dds/psm/qos.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>

namespace sonopose::ros2 {

/// QoS of publishers and subscriptions by topic. Not thread-safe.
class QosOverrides {
public:
  enum class Endpoint : std::uint8_t { publisher, subscription };

  /// Adds a parameter such as "qos_overrides./odom.publisher.reliability". Returns false if it has another
  /// name. Throws std::invalid_argument for an unknown policy or value, with those that are known.
  bool add(const std::string& parameter, const std::string& value);

  /// Changes the QoS of an endpoint of a topic, by its resolved name.
  void apply(const std::string& topic, Endpoint endpoint, dds::Qos& qos) const;

private:
  using Change = std::function<void(dds::Qos& qos)>;
  static Change change_of(const std::string& policy, const std::string& value);

  /// Changes by policy: the last value of each.
  std::map<std::pair<std::string, Endpoint>, std::map<std::string, Change>> changes_;
};

}  // namespace sonopose::ros2
