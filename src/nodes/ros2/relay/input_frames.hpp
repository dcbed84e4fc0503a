#pragma once
/// \file
/// The frames of inputs.

#include "ros2/relay/fixed_frames.hpp"
#include "ros2/relay/input_option.hpp"
#include <sonopose/ros2/messages/frames.hpp>

#include <functional>
#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Frames of the inputs of a beacon. Called on the thread that runs the source.
struct InputFrames {
  using Find = std::function<std::optional<ros2::Transform>(BeaconAddress address, const std::string& frame)>;

  /// Current mount of the IMU on the base.
  std::function<ros2::Mount(BeaconAddress address)> mount;
  Find in_map;   ///< pose of a frame in the map; that of an empty name is the map
  Find in_base;  ///< pose of a frame on the base; that of an empty name is the base
};

/// Frames of these names, and those that `tf` (null: none) connects with them. Both must outlive the result.
InputFrames input_frames(const ros2::FrameNames& names, std::function<ros2::Mount(BeaconAddress)> mount,
                         const FixedFrames* tf);

/// Place of the tag of a topic of fixes in body axes, seen from the IMU. Zero without one; empty if `frames`
/// does not connect its frame.
std::optional<Vector3d> tag_in_body(const Input& input, const InputFrames& frames);

}  // namespace sonopose::ros2::relay
