#pragma once
/// \file
/// ROS 2 drivers as a bridge's source: any IMU, and any positioning system.

#include <sonopose/dds/participant.hpp>
#include <sonopose/nodes/source.hpp>
#include <sonopose/ros2/node.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::nodes {

/// One topic that is taken in, and the beacon that it counts as.
struct Ros2Input {
  enum class Kind : std::uint8_t { imu, fix };
  Kind kind = Kind::imu;
  std::string topic;
  BeaconAddress address = 0;

  /// "/imu/data=7". Throws std::invalid_argument that says what is wrong.
  static Ros2Input parse(Kind kind, std::string_view text);
};

/// Drivers offer no deadline, so none is asked for: an input that has fallen silent for longer
/// is told of on standard error, and so is its return.
struct Ros2Timeouts {
  TimeNs imu_ns = 0;
  TimeNs fix_ns = 0;
};

/// Reads best effort, which reaches reliable writers and best-effort ones. A topic of fixes may be of
/// PointStamped or of PoseWithCovarianceStamped: both are listened for. Messages whose values are not finite
/// are counted (BeaconStatus.samples_rejected). `node` must outlive it; its endpoints are announced by
/// whoever owns it.
std::unique_ptr<Source> make_ros2_source(ros2::Node& node, const std::vector<Ros2Input>& inputs,
                                         const Ros2Timeouts& timeouts);

}  // namespace sonopose::nodes
