#pragma once
/// \file
/// The fixed transforms of /tf_static, for the frames of inputs.

#include "threads/mutex.hpp"
#include <sonopose/ros2/messages/static_transforms.hpp>
#include <sonopose/ros2/node/node.hpp>

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

/// Collects the transforms of all publishers. Thread-safe.
class FixedFrames {
public:
  /// Throws dds::Error.
  explicit FixedFrames(ros2::Node& node);

  /// Pose of a frame in another one; empty if they are not connected.
  [[nodiscard]] std::optional<ros2::Transform> find(const std::string& in, const std::string& frame) const;

private:
  class Listener final : public dds::DataReaderListener<ros2::TFMessage> {
  public:
    explicit Listener(FixedFrames& frames) : frames_(frames) {}
    void on_data_available(dds::DataReader<ros2::TFMessage>& reader) noexcept override;

  private:
    FixedFrames& frames_;
  };

  mutable threads::Mutex mutex_;
  ros2::StaticTransforms transforms_ SONOPOSE_GUARDED_BY(mutex_);
  Listener listener_{*this};
  dds::DataReader<ros2::TFMessage> reader_;  ///< last, because its listener uses the others
};

}  // namespace sonopose::ros2::relay
