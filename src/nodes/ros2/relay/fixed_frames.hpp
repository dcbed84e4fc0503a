#pragma once
/// \file
/// The fixed transforms of /tf_static, for the frames of inputs.

#include "threads/mutex.hpp"
#include <sonopose/ros2/messages/static_transforms.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Collects the transforms of all publishers. Thread-safe.
class FixedFrames {
public:
  /// Throws dds::core::Exception.
  explicit FixedFrames(ros2::Node& node);

  /// Pose of a frame in another one; empty if they are not connected.
  [[nodiscard]] std::optional<ros2::Transform> find(const std::string& in, const std::string& frame) const;

private:
  class Listener final : public dds::sub::NoOpDataReaderListener<ros2::TFMessage> {
  public:
    explicit Listener(FixedFrames& frames) : frames_(frames) {}
    void on_data_available(dds::sub::DataReader<ros2::TFMessage>& reader) noexcept override;

  private:
    FixedFrames& frames_;
  };

  mutable threads::Mutex mutex_;
  ros2::StaticTransforms transforms_ SONOPOSE_GUARDED_BY(mutex_);
  Listener listener_{*this};
  dds::sub::DataReader<ros2::TFMessage> reader_;  ///< last, because its listener uses the others
};

}  // namespace sonopose::ros2::relay
