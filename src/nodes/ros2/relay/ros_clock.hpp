#pragma once
/// \file
/// Time of a ROS 2 node: host time or simulated time.

#include "clocks/clocks.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <atomic>

namespace sonopose::ros2::relay {

/// Clock of a ROS 2 node. Thread-safe, except the constructor.
class RosClock {
public:
  /// `use_sim_time`: follow the topic /clock, as in ROS 2; `node` must outlive the clock. Throws
  /// dds::core::Exception.
  RosClock(ros2::Node& node, bool use_sim_time) : use_sim_time_(use_sim_time) {
    if (use_sim_time) reader_ = node.make_reader<ros2::Clock>("/clock", "ros2::Input", &listener_);
  }
  RosClock(const RosClock&) = delete;
  RosClock& operator=(const RosClock&) = delete;
  ~RosClock() = default;

  /// Current time; 0 before the first message of /clock.
  [[nodiscard]] TimeNs now_ns() const noexcept {
    return use_sim_time_ ? simulated_ns_.load(std::memory_order_relaxed) : clocks::host_now();
  }

  /// True while it follows /clock and has no time after 0 of it.
  [[nodiscard]] bool is_waiting() const noexcept { return use_sim_time_ && now_ns() == 0; }

  /// True after the first message of /clock.
  [[nodiscard]] bool has_message() const noexcept { return has_message_.load(std::memory_order_relaxed); }

private:
  bool use_sim_time_;
  std::atomic<TimeNs> simulated_ns_ = 0;
  std::atomic<bool> has_message_ = false;
  dds::ext::SampleListener<ros2::Clock> listener_{[this](const ros2::Clock& message, const auto&) {
    has_message_ = true;
    if (const auto time_ns = ros2::from_ros(message.clock)) simulated_ns_ = *time_ns;
  }};
  dds::sub::DataReader<ros2::Clock> reader_ = dds::core::null;  ///< last, so that it is destroyed first
};

}  // namespace sonopose::ros2::relay
