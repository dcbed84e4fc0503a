#pragma once
/// \file
/// Samples that a message of velocities, of a heading or of a pose becomes.

#include "ros2/inputs/aiding_input.hpp"
#include "ros2/inputs/input_frames.hpp"
#include "ros2/inputs/input_monitor.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace sonopose::ros2 {

struct AidingSamples {
  std::string_view frame = {};  ///< frame of a velocity, in the message
  std::optional<TwistSample> twist = {};
  std::optional<PairHeading> heading = {};
  std::optional<UltrasonicFix> fix = {};
  std::string unused = {};  ///< parts that are not used, and why; empty: all are used
};

// A heading is that of the body. A pose is a fix, with its place on the body, and a heading.

AidingSamples samples_of(const Odometry& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns);
AidingSamples samples_of(const TwistWithCovarianceStamped& message, const AidingInput& input,
                         const InputFrames& frames, TimeNs received_ns);
AidingSamples samples_of(const TwistStamped& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns);
AidingSamples samples_of(const JointState& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns);
AidingSamples samples_of(const Imu& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns);
AidingSamples samples_of(const PoseWithCovarianceStamped& message, const AidingInput& input,
                         const InputFrames& frames, TimeNs received_ns);
AidingSamples samples_of(const PoseStamped& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns);
AidingSamples samples_of(const Float64& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns);

/// Line about a pose that the user has set, or that is refused.
InputMonitor::Line set_pose_line(const AidingInput& input, const AidingSamples& samples);

}  // namespace sonopose::ros2
