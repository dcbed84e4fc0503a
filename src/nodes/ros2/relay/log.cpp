#include "ros2/relay/log.hpp"

#include "logging/log.hpp"
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/time.hpp>

namespace sonopose::ros2::relay {
namespace {

LogLevel ros_level(logging::Level level) {
  switch (level) {
    case logging::Level::debug:
      return LogLevel::debug;
    case logging::Level::info:
      return LogLevel::info;
    case logging::Level::warning:
      return LogLevel::warning;
    case logging::Level::error:
      return LogLevel::error;
    case logging::Level::failure:
      break;
  }
  return LogLevel::fatal;
}

}  // namespace

void Log::publish_as(ros2::Node& node) {
  logger_ = ros2::logger_name(node.names().node());
  writer_ = node.make_writer<ros2::LogMessage>("/rosout", "ros2::Rosout");
  listening_.emplace(*this);
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

void Log::on(const logging::Line& line) noexcept {
  try {
    static const std::string unknown;
    const std::string text(line.text);
    ros2::LogMessage message{};
    message.stamp = ros2::to_ros(line.time_ns);
    message.level = static_cast<std::uint8_t>(ros_level(line.level));
    message.name = ros2::borrow_string(logger_);
    message.msg = ros2::borrow_string(text);
    message.file = ros2::borrow_string(unknown);
    message.function = ros2::borrow_string(unknown);
    dds::ext::try_write(writer_, message);
  } catch (...) {  // NOLINT(bugprone-empty-catch): no memory for the line
  }
}

}  // namespace sonopose::ros2::relay
