#pragma once
/// \file
/// The log lines of the relay.

#include "logging/log.hpp"
#include "ros2/arguments/arguments.hpp"
#include "transitions/line.hpp"
#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2::relay {

using arguments::LogLevel;

/// Level of the process's log.
logging::Level process_level(LogLevel level);

/// Writes lines to the log of the process. If there is a node, the log's own thread publishes all lines of
/// the log on /rosout. Thread-safe after publish_as(). Do not use it on the path of a sample.
class Log final : public logging::Listener {
public:
  /// Publishes the lines of the process as those of this node. Throws dds::core::Exception.
  void publish_as(ros2::Node& node);

  void info(const std::string& line) { logging::info(line); }
  void warning(const std::string& line) { logging::warning(line); }
  void error(const std::string& line) { logging::error(line); }
  void write(const transitions::Line& line) { logging::write(line.level, line.text); }

private:
  void on(const logging::Line& line) noexcept override;

  std::string logger_;
  dds::pub::DataWriter<ros2::LogMessage> writer_ = dds::core::null;
  std::optional<logging::Listening> listening_;  ///< destroyed first
};

}  // namespace sonopose::ros2::relay
