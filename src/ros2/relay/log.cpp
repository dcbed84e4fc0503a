#include "ros2/relay/log.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/time.hpp>

namespace sonopose::ros2::relay {

void Log::publish_as(ros2::Node& node) {
  logger_ = ros2::logger_name(node.names().node());
  writer_ = node.make_writer<ros2::LogMessage>("/rosout", "ros2::Rosout");
}

logging::Level process_level(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return logging::Level::debug;
    case LogLevel::info:
      return logging::Level::info;
    case LogLevel::warning:
      return logging::Level::warning;
    case LogLevel::error:
      return logging::Level::error;
    case LogLevel::fatal:
      return logging::Level::failure;
  }
  return logging::Level::failure;
}

void Log::write(const transitions::Line& line) {
  switch (line.level) {
    case logging::Level::debug:
      return write(LogLevel::debug, line.text);
    case logging::Level::info:
      return write(LogLevel::info, line.text);
    case logging::Level::warning:
      return write(LogLevel::warning, line.text);
    default:
      return write(LogLevel::error, line.text);
  }
}

void Log::write(LogLevel level, const std::string& line) {
  if (level < least_) return;
  logging::write(process_level(level), line);
  if (writer_.is_nil()) return;
  static const std::string unknown;
  ros2::LogMessage message{};
  message.stamp = ros2::to_ros(clocks::host_now());
  message.level = static_cast<std::uint8_t>(level);
  message.name = ros2::borrow_string(logger_);
  message.msg = ros2::borrow_string(line);
  message.file = ros2::borrow_string(unknown);
  message.function = ros2::borrow_string(unknown);
  writer_.try_write(message);
}

}  // namespace sonopose::ros2::relay
