#pragma once
/// \file
/// The fixed transforms of /tf_static, for the frames of inputs and the mount of the IMU.

#include "ros2/relay/beacon_publishers.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Collects the transforms of all publishers. Thread-safe.
class FixedFrames {
public:
  /// `wake`, if given, is called on new transforms, under the rules of a listener. Throws
  /// dds::core::Exception.
  explicit FixedFrames(ros2::Node& node, std::function<void()> wake = {});

  /// Pose of a frame in another one; empty if they are not connected.
  [[nodiscard]] std::optional<ros2::Transform> find(const std::string& in, const std::string& frame) const;

  /// Gives a beacon the mount of the IMU in the robot's own description, and logs a changed one, or that
  /// there is none for a while. Main thread only.
  void assign_mount_to(BeaconPublishers& publishers);

private:
  void add(const ros2::TFMessage& message);
  void report_missing(const ros2::FrameNames& frames);

  std::function<void()> wake_;
  mutable threads::Mutex mutex_;
  ros2::StaticTransforms transforms_ SONOPOSE_GUARDED_BY(mutex_);
  bool has_surplus_ SONOPOSE_GUARDED_BY(mutex_) = false;
  bool reported_ = false;                            ///< main thread only
  std::map<std::string, SteadyTime> missing_since_;  ///< by frame of the IMU, likewise
  dds::ext::SampleListener<ros2::TFMessage> listener_{
      [this](const ros2::TFMessage& message, const auto&) { add(message); }};
  dds::sub::DataReader<ros2::TFMessage> reader_;  ///< last, because its listener uses the others
};

}  // namespace sonopose::ros2::relay
