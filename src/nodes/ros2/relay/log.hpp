#pragma once
/// \file
/// The log lines of the relay on /rosout.

#include "logging/log.hpp"
#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Publishes all lines of the log of the process on /rosout, on the thread of the log.
class Log final : public logging::Listener {
public:
  /// Publishes the lines of the process as those of this node. Throws dds::core::Exception.
  void publish_as(ros2::Node& node);

private:
  void on(const logging::Line& line) noexcept override;

  std::string logger_;
  dds::pub::DataWriter<ros2::LogMessage> writer_ = dds::core::null;
  std::optional<logging::Listening> listening_;  ///< destroyed first
};

}  // namespace sonopose::ros2::relay
