#include "ros2/relay/log.hpp"

#include "logging/log.hpp"
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/time.hpp>

namespace sonopose::ros2::relay {

void Log::publish_as(ros2::Node& node) {
  logger_ = ros2::logger_name(node.names().node());
  writer_ = node.make_writer<ros2::LogMessage>("/rosout", "ros2::Rosout");
  listening_.emplace(*this);
}

void Log::on(const logging::Line& line) noexcept {
  try {
    static const std::string unknown;
    const std::string text(line.text);
    ros2::LogMessage message{};
    message.stamp = ros2::to_ros(line.time_ns);
    // rcl_interfaces/msg/Log has the same levels, from 10 to 50.
    message.level = static_cast<std::uint8_t>(10 * (1 + static_cast<int>(line.level)));
    message.name = ros2::borrow_string(logger_);
    message.msg = ros2::borrow_string(text);
    message.file = ros2::borrow_string(unknown);
    message.function = ros2::borrow_string(unknown);
    dds::ext::try_write(writer_, message);
  } catch (...) {  // NOLINT(bugprone-empty-catch): no memory for the line
  }
}

}  // namespace sonopose::ros2::relay
