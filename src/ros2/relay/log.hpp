#pragma once
/// \file
/// The log lines of the relay.

#include "logging/log.hpp"
#include "ros2/arguments/arguments.hpp"
#include "transitions/line.hpp"
#include <sonopose/ros2/messages/node.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <string>

namespace sonopose::ros2::relay {

using arguments::LogLevel;

/// The level of the process's log.
logging::Level process_level(LogLevel level);

/// Lines go to the log of the process, and to /rosout if there is a node for it. Thread-safe after
/// publish_as(). Do not use it on the path of a sample.
class Log {
public:
  /// Lines below `least` are dropped.
  explicit Log(LogLevel least = LogLevel::info) : least_(least) {}

  /// Publishes later lines as those of this node. Throws dds::Error.
  void publish_as(ros2::Node& node);

  void info(const std::string& line) { write(LogLevel::info, line); }
  void warning(const std::string& line) { write(LogLevel::warning, line); }
  void error(const std::string& line) { write(LogLevel::error, line); }
  void write(const transitions::Line& line);

private:
  void write(LogLevel level, const std::string& line);

  LogLevel least_;
  std::string logger_;
  dds::DataWriter<ros2::LogMessage> writer_;
};

}  // namespace sonopose::ros2::relay
