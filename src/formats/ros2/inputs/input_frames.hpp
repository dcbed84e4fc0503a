#pragma once
/// \file
/// The frames of inputs.

#include "ros2/inputs/input_option.hpp"
#include <sonopose/ros2/messages/frames.hpp>

#include <functional>
#include <optional>
#include <string>

namespace sonopose::ros2 {

/// Frames of the inputs of a beacon. Called on the thread that runs the source.
struct InputFrames {
  using Find = std::function<std::optional<Transform>(BeaconAddress address, const std::string& frame)>;

  /// Current mount of the IMU on the base; empty while it is not known.
  std::function<std::optional<Mount>(BeaconAddress address)> mount;
  Find in_map;   ///< pose of a frame in the map; that of an empty name is the map
  Find in_base;  ///< pose of a frame on the base; that of an empty name is the base
};

/// Finds the pose of the frame `frame` in the frame `in`; empty if they are not connected.
using FindFrame = std::function<std::optional<Transform>(const std::string& in, const std::string& frame)>;

/// Frames of these names, which must outlive the result, and those that `tf` (empty: none) connects with
/// them.
InputFrames input_frames(const FrameNames& names, std::function<std::optional<Mount>(BeaconAddress)> mount,
                         const FindFrame& tf);

/// Place of the tag of a topic of fixes in body axes, seen from the IMU. Zero without one; empty, with the
/// reason in `unused`, if its frame or the mount is not known.
std::optional<Vector3d> tag_in_body(const Input& input, const InputFrames& frames, std::string& unused);

/// Reason why a sample that needs the mount is not used while it is not known.
inline constexpr const char* mount_unknown = "/tf_static does not have the mount of the IMU on the base yet";

}  // namespace sonopose::ros2
