#pragma once
/// \file
/// Time of a ROS 2 node: host time or simulated time.

#include "clocks/clocks.hpp"
#include <sonopose/ros2/node/node.hpp>

#include <atomic>

namespace sonopose::ros2::relay {

/// Clock of a ROS 2 node. Thread-safe, except the constructor.
class RosClock {
public:
  /// `use_sim_time`: follow the topic /clock, as in ROS 2; `node` must outlive the clock. Throws
  /// dds::core::Exception.
  RosClock(ros2::Node& node, bool use_sim_time);
  RosClock(const RosClock&) = delete;
  RosClock& operator=(const RosClock&) = delete;
  RosClock(RosClock&&) = delete;
  RosClock& operator=(RosClock&&) = delete;
  ~RosClock() = default;

  /// Current time; 0 before the first message of /clock.
  [[nodiscard]] TimeNs now_ns() const noexcept {
    return use_sim_time_ ? simulated_ns_.load(std::memory_order_relaxed) : clocks::host_now();
  }

private:
  class Listener final : public dds::sub::NoOpDataReaderListener<ros2::Clock> {
  public:
    explicit Listener(std::atomic<TimeNs>& simulated_ns) : simulated_ns_(simulated_ns) {}
    void on_data_available(dds::sub::DataReader<ros2::Clock>& reader) noexcept override;

  private:
    std::atomic<TimeNs>& simulated_ns_;
  };

  bool use_sim_time_;
  std::atomic<TimeNs> simulated_ns_ = 0;
  Listener listener_{simulated_ns_};
  dds::sub::DataReader<ros2::Clock> reader_ = dds::core::null;  ///< last, so that it is destroyed first
};

}  // namespace sonopose::ros2::relay
