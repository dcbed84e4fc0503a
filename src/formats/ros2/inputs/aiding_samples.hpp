#pragma once
/// \file
/// Samples that a message of velocities, of a heading or of a pose becomes.

#include "ros2/inputs/aiding_input.hpp"
#include "ros2/inputs/input_frames.hpp"
#include "ros2/inputs/input_monitor.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2 {

struct AidingSamples {
  std::optional<TwistSample> twist = {};
  std::optional<PairHeading> heading = {};
  std::optional<UltrasonicFix> fix = {};
  std::string unused = {};  ///< parts that are not used, and why; empty: all are used

  /// Time of measurement; empty if there is no sample.
  [[nodiscard]] std::optional<TimeNs> measured_ns() const {
    if (twist) return twist->emission_time_ns;
    if (heading) return heading->emission_time_ns;
    return fix ? std::optional(fix->emission_time_ns) : std::nullopt;
  }
};

// A velocity is moved from its frame to the IMU, both as parts of one rigid body. A heading is that of the
// body. A pose is a fix, with its place on the body, and a heading.

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
