#pragma once
/// \file
/// ROS 2 drivers (any IMU, any positioning system) as a source of a bridge.

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "publication/source.hpp"
#include "ros2/inputs/input_option.hpp"
#include "ros2/relay/aiding_inputs.hpp"
#include <sonopose/ros2/node/node.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sonopose::ros2::relay {

/// Timeouts of the inputs. Longer silences are logged, and their ends (InputMonitor). Drivers offer no
/// deadline, so the readers request none.
struct InputTimeouts {
  TimeNs imu_ns = 0;
  TimeNs fix_ns = 0;
};

/// Topics of ROS 2 as beacons. In a beacon's BeaconStatus, `frames` counts messages, and `samples_rejected`
/// counts messages with a non-finite value or an invalid stamp, and those of a gyroscope without a specific
/// force near them. `clock_offset_s` is the age of samples when
/// they are processed: of the IMU if the beacon has one, else of the fixes. It is the minimum of the last
/// second, which is closest to the offset of the clocks.
class Source : public publication::Source {
public:
  /// Number of messages of this beacon lost since the start because a reader's queue was full. Messages lost
  /// by the network are unknown and not included. 0 for a beacon without an input. Thread-safe.
  [[nodiscard]] virtual std::uint64_t samples_lost(BeaconAddress address) const noexcept = 0;

  /// Creates the reader of each topic of fixes as soon as a publisher shows its type, and logs publishers of
  /// other types. Call it on the thread of the node, and Node::announce() after it. Returns the time before
  /// which further calls do nothing. Throws dds::core::Exception.
  virtual SteadyTime update_readers() = 0;

  /// Passes on these velocities, headings and poses too. Call it before run().
  virtual void use(std::unique_ptr<AidingInputs> aiding) = 0;

  /// Finds the places of tags in these frames. Call it before run() if a topic of fixes has a place.
  virtual void use(InputFrames frames) = 0;

  /// Formats and logs the changes that run() has found. Call it about once a second, and at the end, on the
  /// thread of update_readers(): the thread of run() passes samples on.
  virtual void log_changes() = 0;
};

/// Receives a line without a newline: "beacon 7: no IMU samples from ROS 2 yet: …". Called in log_changes()
/// and update_readers().
using LineLogger = std::function<void(logging::Level level, const std::string& line)>;

/// Current time in the clock of ROS 2, in nanoseconds. Called on the thread that runs the source.
using TimeSource = std::function<TimeNs()>;

/// Creates the source. Readers are best effort, which matches every writer, and queue messages until run()
/// takes them (profile ros2::Input). Topics of known type are subscribed to immediately, the others in
/// update_readers(): two readers of different types would make a topic unusable for the tools of ROS 2.
///
/// The time of reception is the time of processing; for a message without a stamp, it is also the time of
/// measurement. These times are unique. For a fix, it is in the clock of the stamps of its beacon's IMU
/// (StampClock). Fixes are used as positions in the map and IMU samples as readings in body axes, regardless
/// of their frames. Frames of fixes other than `map_frame` (`{address}` is replaced), and changes of an IMU's
/// frame, are logged. `log`: by default writes to standard error. `now`: time of reception.
///
/// `node` must outlive the source, and its owner must announce the new endpoints. Throws
/// std::invalid_argument for conflicting inputs (see check), dds::core::Exception.
std::unique_ptr<Source> make_source(ros2::Node& node, const std::vector<Input>& inputs,
                                    const InputTimeouts& timeouts, const std::string& map_frame = "map",
                                    LineLogger log = {}, TimeSource now = clocks::host_now);

}  // namespace sonopose::ros2::relay
