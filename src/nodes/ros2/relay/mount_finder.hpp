#pragma once
/// \file
/// Finds the mount of the IMU in the robot's own description, which another node publishes on /tf_static.

#include "ros2/relay/beacon_publishers.hpp"
#include "threads/mutex.hpp"
#include <sonopose/ros2/messages/static_transforms.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <functional>

namespace sonopose::ros2::relay {

class MountFinder {
public:
  /// `wake` is called on new transforms, under the rules of a listener. Throws
  /// dds::core::Exception.
  MountFinder(ros2::Node& node, std::function<void()> wake);

  /// Gives a beacon the mount known for its frames, and logs a changed one. Main thread only.
  void assign_to(BeaconPublishers& publishers);

private:
  class Listener final : public dds::sub::NoOpDataReaderListener<ros2::TFMessage> {
  public:
    explicit Listener(MountFinder& finder) : finder_(finder) {}
    void on_data_available(dds::sub::DataReader<ros2::TFMessage>& reader) noexcept override;

  private:
    MountFinder& finder_;
  };

  std::function<void()> wake_;
  threads::Mutex mutex_;
  ros2::StaticTransforms transforms_ SONOPOSE_GUARDED_BY(mutex_);
  bool has_surplus_ SONOPOSE_GUARDED_BY(mutex_) = false;
  bool reported_ = false;  ///< main thread only
  Listener listener_{*this};
  dds::sub::DataReader<ros2::TFMessage> reader_;  ///< last, because its listener uses the others
};

}  // namespace sonopose::ros2::relay
