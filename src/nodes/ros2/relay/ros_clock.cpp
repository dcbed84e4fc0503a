#include "ros2/relay/ros_clock.hpp"

#include <sonopose/ros2/messages/time.hpp>

namespace sonopose::ros2::relay {

RosClock::RosClock(ros2::Node& node, bool use_sim_time) : use_sim_time_(use_sim_time) {
  if (use_sim_time) reader_ = node.make_reader<ros2::Clock>("/clock", "ros2::Input", &listener_);
}

void RosClock::Listener::on_data_available(dds::sub::DataReader<ros2::Clock>& reader) noexcept {
  dds::ext::try_take_each(reader, [this](const ros2::Clock& message, const dds::sub::SampleInfo&) {
    if (const auto time_ns = ros2::from_ros(message.clock)) simulated_ns_ = *time_ns;
  });
}

}  // namespace sonopose::ros2::relay
