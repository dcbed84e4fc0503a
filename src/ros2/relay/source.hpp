#pragma once
/// \file
/// ROS 2 drivers as a bridge's source: any IMU, and any positioning system.

#include "ros2/relay/input_option.hpp"
#include "bridge/source.hpp"
#include <sonopose/ros2/messages/node.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Drivers offer no deadline, so none is asked for: an input that has fallen silent for longer, or was never
/// heard since the start (Ros2InputDetector), is told of, and so is its return.
struct Ros2Timeouts {
  TimeNs imu_ns = 0;
  TimeNs fix_ns = 0;
};

/// Topics of ROS 2 as beacons. What a beacon's inputs have brought stands in its BeaconStatus: messages
/// (`frames`), those that were left out since a value is not finite or the stamp is none
/// (`samples_rejected`), and the age of the samples when they are taken (`clock_offset_s`: the IMU's where
/// the beacon has one, else the fixes'; the smallest of the last second, which is nearest to the offset of
/// the clocks).
class Ros2Source : public bridge::Source {
public:
  /// Messages for this beacon that were refused since the input was held up for too long, since the start.
  /// Messages that the network lost are not among them: nobody tells of those. 0 for a beacon without an
  /// input. From any thread.
  [[nodiscard]] virtual std::uint64_t samples_lost(BeaconAddress address) const noexcept = 0;
};

/// Takes a line of text, without an end of line: "beacon 7: no IMU samples from ROS 2 yet: …". Called on the
/// thread that runs the source.
using Ros2Teller = std::function<void(const std::string& line)>;

/// Joins the topics at once. Reads best effort, which reaches reliable writers and best-effort ones; keeps
/// what comes until run() takes it (profile ros2::Input). A topic of fixes may be of PointStamped or of
/// PoseWithCovarianceStamped: both are listened for.
///
/// A message counts as received when it is taken, and as measured then where it has no stamp; the times of
/// two messages differ by a nanosecond at the least. Fixes are taken as positions in the map whatever
/// their frame is, and IMU samples as of the beacon's body axes; a frame that is not `map_frame`
/// (`{address}` in it stands for the beacon's), and an IMU's that changes, is told of. `tell`: empty for
/// standard error.
///
/// `node` must outlive the source; its endpoints are announced by whoever owns it. Throws
/// std::invalid_argument for inputs that do not go together (check), dds::Error.
std::unique_ptr<Ros2Source> make_ros2_source(ros2::Node& node, const std::vector<Ros2Input>& inputs,
                                             const Ros2Timeouts& timeouts,
                                             const std::string& map_frame = "map", Ros2Teller tell = {});

}  // namespace sonopose::ros2
