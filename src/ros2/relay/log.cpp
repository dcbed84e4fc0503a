#include "ros2/relay/log.hpp"

#include "clocks/clocks.hpp"
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <fmt/format.h>

#include <cstdio>

namespace sonopose::ros2::relay {

void Log::publish_as(ros2::Node& node) {
  logger_ = ros2::logger_name(node.names().node());
  writer_ = node.make_writer<ros2::LogMessage>("/rosout", "ros2::Rosout");
}

void Log::write(LogLevel level, const std::string& line) {
  if (level < least_) return;
  fmt::print(stderr, "sonopose-ros2: {}{}\n", level == LogLevel::warning ? "warning: " : "", line);
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
